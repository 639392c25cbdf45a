// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "datasets/bag/bag.h"

namespace plumbline {

/// sensor_msgs/Image. `data` is that of the message.
struct ImageMessage {
  TimeNs t = 0;  ///< header.stamp [ns]
  std::uint32_t width = 0, height = 0;
  std::string encoding;  ///< "mono8", "bayer_rggb8", ...
  bool big_endian = false;
  std::uint32_t step = 0;  ///< from one row to the next [bytes]
  std::string_view data;
};

/// sensor_msgs/CompressedImage: a JPEG or PNG file.
struct CompressedImageMessage {
  TimeNs t = 0;
  std::string format;
  std::string_view data;
};

/// Decode a message of that type, as its topic states it; nothing where it is cut or not laid out
/// so. Of sensor_msgs/Imu the stamp, angular_velocity [rad/s] and linear_acceleration [m/s^2], a
/// specific force (REP 145), are kept.
[[nodiscard]] std::optional<ImageMessage> decodeImage(const BagMessage& message);
[[nodiscard]] std::optional<CompressedImageMessage> decodeCompressedImage(
    const BagMessage& message);
[[nodiscard]] std::optional<ImuSample> decodeImu(const BagMessage& message);

}  // namespace plumbline
