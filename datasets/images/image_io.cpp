// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/images/image_io.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

// libpng leaves by longjmp, which runs no destructors: the functions that call it hold only plain
// values, and the samples belong to the caller.
struct DeepReader {
  explicit DeepReader(std::string_view bytes) : left(bytes) {}
  ~DeepReader() { png_destroy_read_struct(&png, &info, nullptr); }
  DeepReader(const DeepReader&) = delete;
  DeepReader& operator=(const DeepReader&) = delete;

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

/// ITU-R BT.601's luma, as libjpeg has it.
std::uint8_t luma(const std::uint8_t* rgb) {
  // 0.299, 0.587, 0.114 in 1/65536, rounded.
  return static_cast<std::uint8_t>((19595U * rgb[0] + 38470U * rgb[1] + 7471U * rgb[2] + 32768U) >>
                                   16U);
}

/// A PNG of 16 bits whose samples use `bits` of them; their greatest value is white.
struct DeepImage {
  GrayImage image;
  int bits = 16;
};

DeepImage decodeDeepPng(std::string_view bytes, const SizeCheck& check) {
  DeepReader reader(bytes);
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

/// By its first bytes, whatever its name ends in.
GrayImage decode(const std::string& path, std::string_view bytes, const SizeCheck& check) {
  if (bytes.starts_with(kPngStart)) return decodePng(bytes, check);
  if (bytes.starts_with("\xFF\xD8\xFF")) return decodeJpeg(bytes, check);
  throw badInput(path, {InputFault::kSyntax, bytes.empty() ? "is empty" : "is neither PNG nor JPEG",
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
    throw badInput(path,
                   {InputFault::kContradiction, fmt::format("is {}x{} pixels", width, height),
                    fmt::format("{}x{}, as stated", stated->width, stated->height),
                    "correct the resolution in sensor.yaml, or remove images of another size"});
  }
  if (pixels > 0 && pixels <= kMostPixels) return;
  throw badInput(path, {InputFault::kOutOfRange, fmt::format("is {}x{} pixels", width, height),
                        fmt::format("1 to {} pixels", kMostPixels),
                        "copy it again or delete it from the recording"});
}

BadInput badImage(const std::string& path, const DecodeError& error) {
  if (error.unsupported) {
    return badInput(
        path, {InputFault::kUnsupported, error.message, "grey levels or RGB", "convert it to PNG"});
  }
  return badInput(path,
                  {InputFault::kSyntax, "the image is damaged or cut short (" + error.message + ")",
                   "a whole PNG or JPEG", "copy it again or delete it from the recording"});
}

/// What `decode` makes of a file's bytes and the check of its size.
template <class Decode>
auto decodedFile(const std::string& path, const std::optional<Resolution>& stated, Decode decode) {
  const MappedFile file(path);
  try {
    return decode(file.text(), [&](std::uint32_t width, std::uint32_t height) {
      checkSize(path, width, height, stated);
    });
  } catch (const DecodeError& error) {
    throw badImage(path, error);
  }
}

/// Bits of a sample, which follow the size in a PNG's first chunk.
int bitDepth(std::string_view bytes) {
  constexpr std::size_t kPlace = 24;
  return bytes.starts_with(kPngStart) && bytes.size() > kPlace ? bytes[kPlace] : 0;
}

/// `pixels`: rows without gaps, of libpng's `format`.
void writeEncoded(const std::string& path, Resolution size, png_uint_32 format, const void* pixels,
                  PngEffort effort) {
  if (size.width <= 0 || size.height <= 0) {
    throw badInput(
        path, {InputFault::kUnwritable, "an empty image cannot be written", "at least one pixel"});
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(size.width);
  png.height = static_cast<png_uint_32>(size.height);
  png.format = format;
  if (effort == PngEffort::kFast) png.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t bytes_needed = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(bytes_needed, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &bytes_needed, 0, pixels, 0, nullptr) == 0) {
    throw badInput(
        path, {InputFault::kUnwritable, "cannot be encoded (" + std::string(png.message) + ")"});
  }
  writeFileAtomically(path, std::string_view(bytes).substr(0, bytes_needed));
}

}  // namespace

GrayImage readGrayImage(const std::string& path, std::optional<Resolution> stated) {
  return decodedFile(path, stated, [&](std::string_view bytes, const SizeCheck& check) {
    return decode(path, bytes, check);
  });
}

std::optional<int> bitsOfDeepImage(const std::string& path) {
  return decodedFile(path, {}, [](std::string_view bytes, const SizeCheck& check) {
    return bitDepth(bytes) == 16 ? std::optional(decodeDeepPng(bytes, check).bits) : std::nullopt;
  });
}

void writePng(const std::string& path, const GrayImage& image, PngEffort effort) {
  writeEncoded(path, {image.width(), image.height()}, PNG_FORMAT_GRAY, image.data(), effort);
}

// What libpng calls linear are samples of 16 bits, which it leaves as they are.
void writeDeepPng(const std::string& path, const DeepGrayImage& image, PngEffort effort) {
  assert(image.samples.size() == std::size_t(image.width) * std::size_t(image.height));
  writeEncoded(path, {image.width, image.height}, PNG_FORMAT_LINEAR_Y, image.samples.data(),
               effort);
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
