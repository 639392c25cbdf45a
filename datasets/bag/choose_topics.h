// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/bag/import_bag.h"

namespace plumbline {

inline constexpr const char* kImageType = "sensor_msgs/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
inline constexpr const char* kImuType = "sensor_msgs/Imu";

/// The topics of a session.
struct SessionTopics {
  std::vector<BagTopic> cameras;  ///< cam0, cam1, ...
  std::optional<BagTopic> imu;
};

/// Chooses them as BagImport says. `imu_yaml_topic`: the rostopic of the given imu.yaml; "": none.
/// Throws InputError where a topic is missing or of another type, no topic has images, the IMU's is
/// not clear, or there is none though an imu.yaml is given.
SessionTopics chooseTopics(const std::vector<BagTopic>& topics, const BagImport& request,
                           const std::string& imu_yaml_topic);

}  // namespace plumbline
