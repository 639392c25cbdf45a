// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "datasets/bag/bag.h"

namespace plumbline {

/// What of a recording becomes a session.
struct BagImport {
  /// Files and folders of one recording (bagFiles()); the order does not matter.
  std::vector<std::string> bags;
  /// Of cam0, cam1, ... in this order. Empty: every topic of images but those with "depth" in their
  /// name, in small letters or not, by name; of a camera that is there both as sensor_msgs/Image
  /// and compressed, the first, unless it alone has no message.
  std::vector<std::string> camera_topics;
  /// Of sensor_msgs/Imu. Empty: that which `imu_path` states, or the only one.
  std::optional<std::string> imu_topic;
  bool import_imu = true;                  ///< false: as if there were no such topic
  std::optional<std::string> target_path;  ///< Kalibr's target.yaml, to lie in the session
  std::optional<std::string> imu_path;     ///< Kalibr's imu.yaml, likewise
  int threads = 0;                         ///< that write images; 0: all cores
  /// Told the number of messages done and of all.
  std::function<void(std::size_t, std::size_t)> progress;
};

/// What a sensor's topic gave.
struct ImportedSensor {
  std::string name;  ///< "cam0", "imu0"
  std::string topic;
  Resolution resolution;     ///< of a camera
  std::size_t count = 0;     ///< images or samples written
  std::size_t repeated = 0;  ///< messages left out: the same once more, with the same stamp
  TimeNs first = 0, last = 0;
  double rate_hz = 0;  ///< 1 / median interval; 0 where there is none
};

/// The topics of all bags by name, with the sum of their messages.
std::vector<BagTopic> topicsOf(const std::vector<std::string>& bags);

/// Writes a session in EuRoC's layout (session_reader.h) into a folder of its own (output.h) that
/// is there: mav0/camN/{data.csv,sensor.yaml,data/<ns>.png}, mav0/imu0/data.csv, and target.yaml,
/// imu.yaml where they are given. Stamps are those of the messages' headers, by the sensors'
/// clocks, not the times of receipt. Images are grey (pixels.h), compressed ones stay the files
/// that they are. The bytes written do not depend on the threads.
///
/// Throws InputError for a topic that is not there, of another type or to be chosen, messages that
/// are cut, encodings without a grey image, images of another size than the first, stamps of 0, two
/// different messages with one stamp, samples that are not finite, a topic without messages, and an
/// IMU topic that lacks angular rate or specific force throughout (of drivers that publish two
/// half-filled topics).
std::vector<ImportedSensor> importBags(const BagImport& request,
                                       const std::filesystem::path& folder);

}  // namespace plumbline
