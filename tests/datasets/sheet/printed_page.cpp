// SPDX-License-Identifier: BSD-3-Clause
#include "tests/datasets/sheet/printed_page.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <zlib.h>

#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

constexpr double kMmPerPoint = 25.4 / 72;
constexpr int kSubpixels = 4;  // along each axis, as edges fall between pixels

/// Operators, each behind its numbers; up to the text, which cairo writes last.
std::string drawingOf(const std::string& pdf) {
  constexpr std::string_view kBegin = "stream\n";
  const std::size_t at = pdf.find(kBegin) + kBegin.size();
  std::string drawing(4 << 20, ' ');
  uLongf size = drawing.size();
  const auto* const bytes = reinterpret_cast<const Bytef*>(pdf.data());
  auto* const out = reinterpret_cast<Bytef*>(drawing.data());
  if (uncompress(out, &size, bytes + at, pdf.size() - at) != Z_OK) {
    throw std::runtime_error("the page's drawing cannot be read");
  }
  return drawing.substr(0, std::min<std::size_t>(size, drawing.find("BT")));
}

/// Draws on an image that is `scale` times as large as the page in points.
class PagePainter {
 public:
  PagePainter(GrayImage& image, double scale) : image_(image), scale_(scale) {}

  void apply(const std::string& word, const std::vector<double>& n) {
    if (word == "cm" && (n[0] != 1 || n[1] != 0 || n[2] != 0 || std::abs(n[3]) != 1)) {
      throw std::runtime_error("a drawing that is scaled or turned");  // y points down, as here
    }
    if (word == "rg") grey_ = static_cast<std::uint8_t>(std::lround(255 * n[0]));
    if (word == "re") {
      paths_.emplace_back(Eigen::Vector2d(n[0], n[1]), Eigen::Vector2d(n[0] + n[2], n[1] + n[3]));
    }
    if (word == "m") path_ = Eigen::AlignedBox2d(Eigen::Vector2d(n[0], n[1]));
    if (word == "l") path_.extend(Eigen::Vector2d(n[0], n[1]));
    if (word == "h") paths_.push_back(path_);
    if (word == "f") fill();
  }

 private:
  void fill() {
    const Eigen::Array2d size(image_.width(), image_.height());
    for (const Eigen::AlignedBox2d& path : paths_) {
      const Eigen::Array2i low = (scale_ * path.min()).array().round().max(0).cast<int>();
      const Eigen::Array2i high = (scale_ * path.max()).array().round().min(size).cast<int>();
      for (int v = low.y(); v < high.y(); ++v) {
        std::fill(image_.row(v) + low.x(), image_.row(v) + high.x(), grey_);
      }
    }
    paths_.clear();
  }

  GrayImage& image_;
  double scale_;
  std::uint8_t grey_ = 0;
  Eigen::AlignedBox2d path_;
  std::vector<Eigen::AlignedBox2d> paths_;
};

}  // namespace

Eigen::Vector2d pageSize(const std::string& pdf) {
  constexpr std::string_view kBox = "/MediaBox [ 0 0 ";
  std::istringstream numbers(pdf.substr(pdf.find(kBox) + kBox.size(), 64));
  Eigen::Vector2d size;
  numbers >> size.x() >> size.y();
  return kMmPerPoint * size;
}

GrayImage printedPage(const std::string& pdf, double pixels_per_mm) {
  const Eigen::Vector2i size = (pixels_per_mm * pageSize(pdf)).array().round().cast<int>();
  GrayImage fine(kSubpixels * size.x(), kSubpixels * size.y());
  PagePainter painter(fine, kSubpixels * pixels_per_mm * kMmPerPoint);
  std::istringstream words(drawingOf(pdf));
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    if (const auto number = parseNumber(word)) {
      numbers.push_back(*number);
    } else {
      painter.apply(word, numbers);
      numbers.clear();
    }
  }
  GrayImage page(size.x(), size.y());
  for (int v = 0; v < size.y(); ++v) {
    for (int u = 0; u < size.x(); ++u) {
      int sum = 0;
      for (int i = 0; i < kSubpixels * kSubpixels; ++i) {
        sum += fine.at(kSubpixels * u + i % kSubpixels, kSubpixels * v + i / kSubpixels);
      }
      page.at(u, v) = static_cast<std::uint8_t>(sum / (kSubpixels * kSubpixels));
    }
  }
  return page;
}

}  // namespace plumbline
