// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "calibrator/base/image.h"

namespace plumbline {

/// Why a file is not the image it claims to be; `message` is the decoder's.
struct DecodeError {
  std::string message;
};

/// Told width and height of the header before anything is decoded; throws where they are refused.
using SizeCheck = std::function<void(std::uint32_t width, std::uint32_t height)>;

/// Decode a whole file in memory as grey levels; throw DecodeError where it is damaged or cut, or
/// repeats its scans without end.
GrayImage decodeJpeg(std::string_view bytes, const SizeCheck& check);

/// A grey image as the bytes of a JPEG file. `quality` 1 to 100. The image is not empty. Throws
/// InputError where libjpeg refuses it.
std::string encodeJpeg(const GrayImage& image, int quality);

}  // namespace plumbline
