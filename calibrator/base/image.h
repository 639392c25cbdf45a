// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "calibrator/base/session.h"

namespace plumbline {

/// A grey image that belongs to someone else: 8 bits a pixel, rows `stride` bytes apart. Pixel
/// (column x, row y) lies at data[y * stride + x]; (0, 0) is the centre of the first pixel.
struct GrayImageView {
  const std::uint8_t* data = nullptr;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  int stride = 0;  ///< [bytes], >= width

  bool empty() const { return width <= 0 || height <= 0; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  const std::uint8_t* row(int y) const {
    return data + static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(stride);
  }
  std::uint8_t at(int x, int y) const {
    assert(contains(x, y));
    return row(y)[x];
  }
};

/// A grey image that owns its pixels; rows follow each other without gaps (stride == width).
class GrayImage {
 public:
  GrayImage() = default;
  GrayImage(int width, int height, std::uint8_t value = 0)
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {
    assert(width >= 0 && height >= 0);
  }
  /// Takes over `pixels`, row by row; their number must be width * height.
  GrayImage(int width, int height, std::vector<std::uint8_t> pixels)
      : width_(width), height_(height), pixels_(std::move(pixels)) {
    assert(pixels_.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }

  std::uint8_t* data() { return pixels_.data(); }
  const std::uint8_t* data() const { return pixels_.data(); }
  std::uint8_t* row(int y) { return pixels_.data() + offset(y); }
  const std::uint8_t* row(int y) const { return pixels_.data() + offset(y); }
  std::uint8_t& at(int x, int y) {
    assert(view().contains(x, y));
    return row(y)[x];
  }
  std::uint8_t at(int x, int y) const { return view().at(x, y); }

  /// Valid as long as this image lives and is not assigned to.
  GrayImageView view() const { return {pixels_.data(), width_, height_, width_}; }

 private:
  std::size_t offset(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> pixels_;
};

/// A grid of equal cells over an image, numbered row by row from the top left.
struct ImageCells {
  int columns = 8, rows = 6;

  int size() const { return columns * rows; }
  /// The cell that holds a pixel (the first pixel's centre is (0, 0)); beside the image the
  /// nearest.
  int cellOf(const Eigen::Vector2d& uv, const Resolution& image) const {
    const auto place = [](double x, int pixels, int cells) {
      return std::clamp(static_cast<int>((x + 0.5) * cells / pixels), 0, cells - 1);
    };
    return place(uv.y(), image.height, rows) * columns + place(uv.x(), image.width, columns);
  }
};

/// Whether a pixel is part of the image.
inline bool isInImage(const Eigen::Vector2d& uv, const Resolution& image) {
  return uv.x() >= -0.5 && uv.x() < image.width - 0.5 && uv.y() >= -0.5 &&
         uv.y() < image.height - 0.5;
}

}  // namespace plumbline
