// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/images/image_io.h"

#include <cstddef>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

struct PngImage {
  png_image image{};
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&image); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

std::vector<std::uint8_t> read(PngImage& png, png_uint_32 format) {
  png.image.format = format;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(png.image));
  const int done = png_image_finish_read(&png.image, nullptr, pixels.data(), 0, nullptr);
  if (done == 0 || PNG_IMAGE_FAILED(png.image)) throw DecodeError{png.image.message};
  return pixels;
}

GrayImage decodePng(std::string_view bytes, const SizeCheck& check) {
  PngImage png;
  if (png_image_begin_read_from_memory(&png.image, bytes.data(), bytes.size()) == 0) {
    throw DecodeError{png.image.message};
  }
  // So libpng marks 16 bits, which it would take for linear light and bend.
  if ((png.image.format & PNG_FORMAT_FLAG_LINEAR) != 0) return decodeDeepPng(bytes, check).image;
  check(png.image.width, png.image.height);
  const int width = static_cast<int>(png.image.width);
  const int height = static_cast<int>(png.image.height);
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  // Through luma(), so that an image in colour gives the same grey as PNG and as JPEG; alpha is
  // left alone, as no background is known.
  const bool colour = (png.image.format & PNG_FORMAT_FLAG_COLOR) != 0;
  const bool alpha = (png.image.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  if (!colour && !alpha) return {width, height, read(png, PNG_FORMAT_GRAY)};
  const std::vector<std::uint8_t> rgba = read(png, PNG_FORMAT_RGBA);
  std::vector<std::uint8_t> grey(count);
  for (std::size_t i = 0; i < count; ++i) grey[i] = luma(&rgba[4 * i]);
  return {width, height, std::move(grey)};
}

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";

bool startsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

/// By its first bytes, whatever its name ends in.
GrayImage decode(const std::string& path, std::string_view bytes, const SizeCheck& check) {
  if (startsWith(bytes, kPngStart)) return decodePng(bytes, check);
  if (startsWith(bytes, "\xFF\xD8\xFF")) return decodeJpeg(bytes, check);
  throw badInput(path, 0,
                 {InputFault::kSyntax, bytes.empty() ? "is empty" : "is neither PNG nor JPEG",
                  "an image", "copy it again or convert it to PNG"});
}

// 128 MB as grey bytes; four times that while a PNG in colour is read, six times if of 16 bits.
constexpr std::uint64_t kMostPixels = 128'000'000;

/// Before decoding, by the header: a small file may claim an image of gigabytes.
void checkSize(const std::string& path, std::uint32_t width, std::uint32_t height,
               const std::optional<Resolution>& stated) {
  const std::uint64_t pixels = std::uint64_t{width} * height;
  if (stated && (width != static_cast<std::uint32_t>(stated->width) ||
                 height != static_cast<std::uint32_t>(stated->height))) {
    throw badInput(path, 0,
                   {InputFault::kContradiction, fmt::format("is {}x{} pixels", width, height),
                    fmt::format("{}x{}, as stated", stated->width, stated->height),
                    "correct the resolution in sensor.yaml, or remove images of another size"});
  }
  if (pixels > 0 && pixels <= kMostPixels) return;
  throw badInput(path, 0,
                 {InputFault::kOutOfRange, fmt::format("is {}x{} pixels", width, height),
                  fmt::format("1 to {} pixels", kMostPixels),
                  "copy it again or delete it from the recording"});
}

BadInput badImage(const std::string& path, const DecodeError& error) {
  if (error.unsupported) {
    return badInput(
        path, 0,
        {InputFault::kUnsupported, error.message, "grey levels or RGB", "convert it to PNG"});
  }
  return badInput(path, 0,
                  {InputFault::kSyntax, "the image is damaged or cut short (" + error.message + ")",
                   "a whole PNG or JPEG", "copy it again or delete it from the recording"});
}

/// Bits of a sample, which follow the size in a PNG's first chunk.
int bitDepth(std::string_view bytes) {
  constexpr std::size_t kPlace = 24;
  return startsWith(bytes, kPngStart) && bytes.size() > kPlace ? bytes[kPlace] : 0;
}

}  // namespace

GrayImage readGrayImage(const std::string& path, std::optional<Resolution> stated) {
  const MappedFile file(path);
  try {
    return decode(path, file.text(), [&](std::uint32_t width, std::uint32_t height) {
      checkSize(path, width, height, stated);
    });
  } catch (const DecodeError& error) {
    throw badImage(path, error);
  }
}

std::optional<int> bitsOfDeepImage(const std::string& path) {
  const MappedFile file(path);
  if (bitDepth(file.text()) != 16) return std::nullopt;
  try {
    return decodeDeepPng(file.text(),
                         [&](std::uint32_t width, std::uint32_t height) {
                           checkSize(path, width, height, {});
                         })
        .bits;
  } catch (const DecodeError& error) {
    throw badImage(path, error);
  }
}

void writePng(const std::string& path, const GrayImage& image, PngEffort effort) {
  if (image.empty()) {
    throw badInput(
        path, 0,
        {InputFault::kUnwritable, "an empty image cannot be written", "at least one pixel"});
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width());
  png.height = static_cast<png_uint_32>(image.height());
  png.format = PNG_FORMAT_GRAY;
  if (effort == PngEffort::kFast) png.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.data(), 0, nullptr) == 0) {
    throw badInput(
        path, 0, {InputFault::kUnwritable, "cannot be encoded (" + std::string(png.message) + ")"});
  }
  writeFileAtomically(path, std::string_view(bytes).substr(0, size));
}

GrayImage shrunk(const GrayImage& image, int factor) {
  if (factor <= 1) return image;
  GrayImage out(image.width() / factor, image.height() / factor);
  const int area = factor * factor;
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      // Rounds to the nearest.
      int sum = area / 2;
      for (int dy = 0; dy < factor; ++dy) {
        const std::uint8_t* row = image.row(y * factor + dy) + x * factor;
        for (int dx = 0; dx < factor; ++dx) sum += row[dx];
      }
      out.at(x, y) = static_cast<std::uint8_t>(sum / area);
    }
  }
  return out;
}

}  // namespace plumbline
