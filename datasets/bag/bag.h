// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline {

/// How a bag lays out the fields of a message: ROS 1 packs them, little-endian; CDR (ROS 2) aligns
/// each to its size behind a header of four bytes that states the byte order.
enum class Serialization { kRos1, kCdr };

/// A topic of a bag; `type` in ROS 1's words for both ("sensor_msgs/Image").
struct BagTopic {
  std::string name;
  std::string type;
  std::size_t messages = 0;
};

/// A message as it lies in a bag, valid while the function that is told of it runs.
struct BagMessage {
  std::string_view topic;
  std::string_view bytes;
  Serialization layout = Serialization::kRos1;
};

/// A recording of ROS, read-only.
class Bag {
 public:
  virtual ~Bag() = default;

  /// In the order of their names.
  virtual std::vector<BagTopic> topics() = 0;

  /// Tells every message of these topics, in the order of receipt. Throws InputError where the bag
  /// is damaged.
  virtual void read(const std::vector<std::string>& topics,
                    const std::function<void(const BagMessage&)>& take) = 0;
};

/// Opens a bag of ROS 1 (format 2.0), or of ROS 2 with SQLite storage: a .db3 file, or the folder
/// of one with its metadata.yaml. The kind is told by the content, not by the name. Nothing is
/// written beside it. Throws InputError for other files, MCAP and compressed files among them, a
/// recording that was not closed, and one of ROS 1 where this build has no reader for it.
std::unique_ptr<Bag> openBag(const std::string& path);

/// The two kinds behind openBag(). `files`: of one recording, in the order of their times; `name`
/// is what errors call it.
std::unique_ptr<Bag> openRos1Bag(const std::string& path);
std::unique_ptr<Bag> openRos2Bag(const std::string& name, const std::vector<std::string>& files);

}  // namespace plumbline
