// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include <png.h>

#include "datasets/images/image_io.h"

namespace plumbline {
namespace {

// libpng leaves by longjmp, which runs no destructors: the functions that call it hold only plain
// values, and the samples belong to the caller.
struct DeepReader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string_view left;  // of the file
  std::jmp_buf exit;
  char message[128] = "";
};

void leaveDeepPng(png_structp png, png_const_charp message) {
  auto* reader = static_cast<DeepReader*>(png_get_error_ptr(png));
  std::snprintf(reader->message, sizeof reader->message, "%s", message);
  std::longjmp(reader->exit, 1);
}

// libpng's simple interface is silent about them too.
void ignoreWarning(png_structp, png_const_charp) {}

void giveBytes(png_structp png, png_bytep out, std::size_t count) {
  auto* reader = static_cast<DeepReader*>(png_get_io_ptr(png));
  if (count > reader->left.size()) png_error(png, "the file ends early");
  std::memcpy(out, reader->left.data(), count);
  reader->left.remove_prefix(count);
}

/// Sets up samples of the machine's own byte order, without alpha.
bool readDeepHeader(DeepReader& reader) {
  if (setjmp(reader.exit) != 0) return false;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, leaveDeepPng, ignoreWarning);
  if (reader.png == nullptr) return false;
  reader.info = png_create_info_struct(reader.png);
  if (reader.info == nullptr) return false;
  png_set_read_fn(reader.png, &reader, giveBytes);
  png_read_info(reader.png, reader.info);
  png_set_strip_alpha(reader.png);
  if (std::endian::native == std::endian::little) png_set_swap(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool readDeepRows(DeepReader& reader, png_bytepp rows) {
  if (setjmp(reader.exit) != 0) return false;
  png_read_image(reader.png, rows);
  return true;
}

/// As sBIT states them; 0 where it does not.
int statedBits(const DeepReader& reader) {
  png_color_8p bits = nullptr;
  if (png_get_sBIT(reader.png, reader.info, &bits) == 0) return 0;
  return std::max({bits->red, bits->green, bits->blue, bits->gray});
}

/// A PNG states the bits of samples that are scaled up to all 16; cameras also leave them at the
/// lower end, which the brightest value tells.
int usedBits(std::uint16_t brightest, int stated) {
  constexpr int kLeast = 8;  // a dark image's noise is not drawn out
  const int width = std::max(kLeast, static_cast<int>(std::bit_width(brightest)));
  if (stated == 0) return width;
  return width <= stated ? std::max(kLeast, stated) : 16;
}

struct DeepPng {
  DeepReader reader;
  DeepPng() = default;
  ~DeepPng() { png_destroy_read_struct(&reader.png, &reader.info, nullptr); }
  DeepPng(const DeepPng&) = delete;
  DeepPng& operator=(const DeepPng&) = delete;
};

}  // namespace

DeepImage decodeDeepPng(std::string_view bytes, const SizeCheck& check) {
  DeepPng file;
  DeepReader& reader = file.reader;
  reader.left = bytes;
  if (!readDeepHeader(reader)) throw DecodeError{reader.message};
  const png_uint_32 width = png_get_image_width(reader.png, reader.info);
  const png_uint_32 height = png_get_image_height(reader.png, reader.info);
  check(width, height);
  const std::size_t channels = png_get_channels(reader.png, reader.info);
  const std::size_t row = width * channels;
  std::vector<std::uint16_t> samples(row * height);
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < height; ++y) {
    rows.push_back(reinterpret_cast<png_bytep>(samples.data() + y * row));
  }
  if (!readDeepRows(reader, rows.data())) throw DecodeError{reader.message};
  DeepImage out;
  out.bits = usedBits(*std::max_element(samples.begin(), samples.end()), statedBits(reader));
  const std::uint32_t most = (1U << static_cast<unsigned>(out.bits)) - 1;
  const auto level = [most](std::uint16_t sample) {  // rounded
    return static_cast<std::uint8_t>((std::min<std::uint32_t>(sample, most) * 255 + most / 2) /
                                     most);
  };
  std::vector<std::uint8_t> grey(std::size_t{width} * height);
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const std::uint16_t* sample = &samples[i * channels];
    const std::uint8_t rgb[] = {level(sample[0]), level(sample[channels / 2]),
                                level(sample[channels - 1])};
    grey[i] = channels == 1 ? rgb[0] : luma(rgb);
  }
  out.image = {static_cast<int>(width), static_cast<int>(height), std::move(grey)};
  return out;
}

}  // namespace plumbline
