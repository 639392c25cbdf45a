// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/images/image_io.h"

#include <png.h>

#include "datasets/files/atomic_file.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/mapped_file.h"
#include "datasets/images/image_codecs.h"

namespace plumbline {
namespace {

bool startsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

GrayImage decode(const std::string& path, std::string_view bytes) {
  if (startsWith(bytes, "\x89PNG\r\n\x1a\n")) return decodePng(bytes);
  if (startsWith(bytes, "\xFF\xD8\xFF")) return decodeJpeg(bytes);
  throw badInput(path, 0,
                 {bytes.empty() ? "is empty" : "is neither PNG nor JPEG", "an image",
                  "copy it again or convert it to PNG"});
}

}  // namespace

GrayImage readGrayImage(const std::string& path) {
  const MappedFile file(path);
  try {
    return decode(path, file.text());
  } catch (const DecodeError& error) {
    throw badInput(path, 0,
                   {"the image is damaged or cut short (" + error.message + ")",
                    "a whole PNG or JPEG", "copy it again or delete it from the recording"});
  }
}

void writePng(const std::string& path, const GrayImage& image) {
  if (image.empty()) {
    throw badInput(path, 0, {"an empty image cannot be written", "at least one pixel", ""});
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width());
  png.height = static_cast<png_uint_32>(image.height());
  png.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.data(), 0, nullptr) == 0) {
    throw badInput(path, 0, {"cannot be encoded (" + std::string(png.message) + ")", "", ""});
  }
  writeFileAtomically(path, std::string_view(bytes).substr(0, size));
}

}  // namespace plumbline
