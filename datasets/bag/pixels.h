// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "calibrator/base/image.h"
#include "datasets/bag/messages.h"
#include "datasets/images/image_io.h"

namespace plumbline {

/// Grey levels of a message, and as many bits of them as it has.
using GrayPixels = std::variant<GrayImage, DeepGrayImage>;

/// The grey image of a sensor_msgs/Image:
///   mono8, 8UC1               as they are
///   mono16, 16UC1             as they are
///   rgb8, bgr8, rgba8, bgra8, 8UC3, 8UC4 (OpenCV's order: blue first)
///                             luma, 0.299 R + 0.587 G + 0.114 B
///   bayer_*8                  the mean over 3 x 3 pixels with weights 1 2 1, which is
///                             (R + 2 G + B) / 4 at every pixel whatever the pattern, and moves
///                             no corner
///   yuv422, uyvy, yuv422_yuy2, yuyv   their Y
/// Nothing for another encoding, or where size, step and data do not fit together.
[[nodiscard]] std::optional<GrayPixels> grayPixels(const ImageMessage& message);

/// Whether an encoding is one of those.
bool isKnownEncoding(const std::string& encoding);

}  // namespace plumbline
