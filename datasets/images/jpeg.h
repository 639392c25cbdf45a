// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "calibrator/base/image.h"

namespace plumbline {

/// Why a file is not the image it claims to be; `message` is the decoder's.
struct DecodeError {
  std::string message;
};

/// Decode a whole file in memory as grey levels; throw DecodeError where it is damaged or cut.
GrayImage decodeJpeg(std::string_view bytes);

/// A grey image as the bytes of a JPEG file. `quality` 1 to 100. The image is not empty. Throws
/// InputError where libjpeg refuses it.
std::string encodeJpeg(const GrayImage& image, int quality);

}  // namespace plumbline
