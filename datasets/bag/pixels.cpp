// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

/// What an encoding keeps in a pixel.
enum class PixelKind { kGray, kDeepGray, kRgb, kBgr, kBayer, kLumaFirst, kLumaSecond };

struct Encoding {
  const char* name;
  PixelKind kind;
  std::size_t bytes;  ///< of a pixel
};

constexpr std::array kEncodings{
    Encoding{"mono8", PixelKind::kGray, 1},
    Encoding{"8UC1", PixelKind::kGray, 1},
    Encoding{"mono16", PixelKind::kDeepGray, 2},
    Encoding{"16UC1", PixelKind::kDeepGray, 2},
    Encoding{"rgb8", PixelKind::kRgb, 3},
    Encoding{"rgba8", PixelKind::kRgb, 4},
    Encoding{"bgr8", PixelKind::kBgr, 3},
    Encoding{"bgra8", PixelKind::kBgr, 4},
    Encoding{"8UC3", PixelKind::kBgr, 3},
    Encoding{"8UC4", PixelKind::kBgr, 4},
    Encoding{"bayer_rggb8", PixelKind::kBayer, 1},
    Encoding{"bayer_bggr8", PixelKind::kBayer, 1},
    Encoding{"bayer_gbrg8", PixelKind::kBayer, 1},
    Encoding{"bayer_grbg8", PixelKind::kBayer, 1},
    Encoding{"yuv422_yuy2", PixelKind::kLumaFirst, 2},
    Encoding{"yuyv", PixelKind::kLumaFirst, 2},
    Encoding{"yuv422", PixelKind::kLumaSecond, 2},
    Encoding{"uyvy", PixelKind::kLumaSecond, 2},
};

const Encoding* encodingOf(const std::string& name) {
  const auto known = std::find_if(kEncodings.begin(), kEncodings.end(),
                                  [&](const Encoding& e) { return name == e.name; });
  return known == kEncodings.end() ? nullptr : known;
}

/// Luma in thousandths, rounded to the nearest.
std::uint8_t luma(int red, int green, int blue) {
  return static_cast<std::uint8_t>((299 * red + 587 * green + 114 * blue + 500) / 1000);
}

std::uint8_t grayOf(const std::uint8_t* pixel, PixelKind kind) {
  switch (kind) {
    case PixelKind::kRgb:
      return luma(pixel[0], pixel[1], pixel[2]);
    case PixelKind::kBgr:
      return luma(pixel[2], pixel[1], pixel[0]);
    case PixelKind::kLumaSecond:
      return pixel[1];
    default:
      return pixel[0];
  }
}

/// Past the border the picture is mirrored at its outermost pixels, which keeps the pattern.
int mirrored(int i, int size) { return i < 0 ? -i : i >= size ? 2 * size - 2 - i : i; }

GrayImage withoutPattern(const GrayImage& mosaic) {
  constexpr std::array kWeights{1, 2, 1};
  GrayImage out(mosaic.width(), mosaic.height());
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      int sum = 8;  // rounds to the nearest
      for (int dy = -1; dy <= 1; ++dy) {
        const std::uint8_t* row = mosaic.row(mirrored(y + dy, out.height()));
        for (int dx = -1; dx <= 1; ++dx) {
          sum += kWeights[dy + 1] * kWeights[dx + 1] * row[mirrored(x + dx, out.width())];
        }
      }
      out.at(x, y) = static_cast<std::uint8_t>(sum / 16);
    }
  }
  return out;
}

DeepGrayImage deepOf(const ImageMessage& m, const std::uint8_t* data) {
  DeepGrayImage out{static_cast<int>(m.width), static_cast<int>(m.height), {}};
  out.samples.reserve(std::size_t{m.width} * m.height);
  for (std::size_t y = 0; y < m.height; ++y) {
    const std::uint8_t* row = data + y * m.step;
    for (std::size_t x = 0; x < m.width; ++x) {
      const unsigned first = row[2 * x], second = row[2 * x + 1];
      out.samples.push_back(
          static_cast<std::uint16_t>(m.big_endian ? first << 8U | second : second << 8U | first));
    }
  }
  return out;
}

}  // namespace

bool isKnownEncoding(const std::string& encoding) { return encodingOf(encoding) != nullptr; }

std::optional<GrayPixels> grayPixels(const ImageMessage& m) {
  constexpr std::uint32_t kMostSide = 1U << 16U;
  const Encoding* encoding = encodingOf(m.encoding);
  if (encoding == nullptr || m.width == 0 || m.height == 0 || m.width > kMostSide ||
      m.height > kMostSide || m.step < m.width * encoding->bytes ||
      m.data.size() < std::size_t{m.step} * (m.height - 1) + m.width * encoding->bytes) {
    return std::nullopt;
  }
  const auto* data = reinterpret_cast<const std::uint8_t*>(m.data.data());
  if (encoding->kind == PixelKind::kDeepGray) return deepOf(m, data);
  GrayImage out(static_cast<int>(m.width), static_cast<int>(m.height));
  for (int y = 0; y < out.height(); ++y) {
    const std::uint8_t* pixel = data + static_cast<std::size_t>(y) * m.step;
    for (int x = 0; x < out.width(); ++x, pixel += encoding->bytes) {
      out.at(x, y) = grayOf(pixel, encoding->kind);
    }
  }
  if (encoding->kind != PixelKind::kBayer) return out;
  // A mosaic has two rows and columns at the least.
  return m.width > 1 && m.height > 1 ? std::optional<GrayPixels>(withoutPattern(out))
                                     : std::nullopt;
}

}  // namespace plumbline
