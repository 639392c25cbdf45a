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

/// A topic of a bag; `type` in ROS 1's words for both ("sensor_msgs/Image"), with how its messages
/// are serialised behind it where they are not read here ("foxglove.RawImage (protobuf)").
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

  /// One that was recorded by several writers, or under several types, may be there several times.
  virtual std::vector<BagTopic> topics() = 0;

  /// Tells every message of these topics, as they lie in the file. Throws InputError where the bag
  /// is damaged.
  virtual void read(const std::vector<std::string>& topics,
                    const std::function<void(const BagMessage&)>& take) = 0;
};

/// The files of a recording: of a folder of ROS 2 those that its metadata.yaml lists; otherwise
/// `path` itself. Throws InputError for a folder without it, and where a file is missing.
std::vector<std::string> bagFiles(const std::string& path);

/// Opens a file: a bag of ROS 1 (format 2.0), an MCAP file, or a .db3 of ROS 2. The kind is told by
/// the content, not by the name. Nothing is written beside it. Throws InputError for other files, a
/// recording that was not closed, compressed .db3 files, and a bag of ROS 1 where this build has no
/// reader for it.
std::unique_ptr<Bag> openBag(const std::string& path);

/// The type of a message in ROS 1's words: ROS 2's without its middle part
/// ("sensor_msgs/msg/Image").
std::string ros1Type(std::string type);

/// The kinds behind openBag().
std::unique_ptr<Bag> openRos1Bag(const std::string& path);
std::unique_ptr<Bag> openRos2Bag(const std::string& path);
std::unique_ptr<Bag> openMcapBag(const std::string& path);

}  // namespace plumbline
