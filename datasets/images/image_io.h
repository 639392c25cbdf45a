// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrator/base/image.h"
#include "calibrator/base/session.h"

namespace plumbline {

/// Reads a PNG (grey or colour, 8 or 16 bits, alpha ignored) or JPEG as grey levels of 0 to 255;
/// colours become luma, 0.299 R + 0.587 G + 0.114 B; of 16 bits the upper 8 of those in use remain,
/// rounded (bitsOfDeepImage()). The kind is told by the content, not by the name. Throws InputError
/// naming the file where it is missing, of another kind, damaged or cut short.
///
/// `stated`: the size that it must have, unless empty. It is compared with the header before
/// anything is decoded (InputError), as is a bound of 128 million pixels that no camera here has.
///
/// libpng and libjpeg-turbo themselves, not OpenCV's imgcodecs: loading that library alone costs
/// 70 ms and 45 MB (measured), as much as a whole calibration.
GrayImage readGrayImage(const std::string& path, std::optional<Resolution> stated = {});

/// The bits in use of a PNG of 16 bits, 8 to 16; empty for any other file. A camera's 10 or 12 bits
/// often stand at the lower end, as they were read out: they are those that the PNG states (sBIT)
/// unless samples are greater (then 16, as the format wants it); without a statement the fewest
/// that hold the brightest. Throws as readGrayImage() does.
std::optional<int> bitsOfDeepImage(const std::string& path);

/// Mean over blocks of `factor` squared pixels; what is left at the right and below is cut off. The
/// image itself for a factor of 1.
GrayImage shrunk(const GrayImage& image, int factor);

/// kFast: half the time for a file a little larger.
enum class PngEffort { kSmall, kFast };

/// Writes an 8-bit grey PNG, whole or not at all. Throws InputError where it cannot be written or
/// the image is empty.
void writePng(const std::string& path, const GrayImage& image,
              PngEffort effort = PngEffort::kSmall);

/// A grey image of 16 bits, row by row.
struct DeepGrayImage {
  int width = 0, height = 0;
  std::vector<std::uint16_t> samples;
};

/// Writes a 16-bit grey PNG with the samples as they are, whole or not at all. Throws as
/// writePng().
void writeDeepPng(const std::string& path, const DeepGrayImage& image,
                  PngEffort effort = PngEffort::kSmall);

/// Why a file is not the image it claims to be; `message` is the decoder's.
struct DecodeError {
  std::string message;
  bool unsupported = false;  ///< it may be whole; `message` says what it is
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
