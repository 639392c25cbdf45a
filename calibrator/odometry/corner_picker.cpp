// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "calibrator/base/option_check.h"
#include "calibrator/odometry/feature_tracker.h"

namespace plumbline {
namespace {

constexpr int kBorder = 12;  // [px]: the tracker's patch and its gradients fit
constexpr int kReach = 3;    // of the 7 x 7 window

struct Candidate {
  Eigen::Vector2f at = Eigen::Vector2f::Zero();
  float score = 0;
};

/// The best pixel of [x0, x1) x [y0, y1). The box of 7 x 7 is summed along rows first, then down:
/// about 14 additions a pixel for each moment in place of 49.
class CellSearch {
 public:
  CellSearch(const GrayImageView& image, int x0, int y0, int x1, int y1)
      : image_(image), x0_(x0), y0_(y0), width_(x1 - x0), height_(y1 - y0) {
    gradients();
    sumRows();
  }

  /// `allowed`(x, y) says where a corner may be.
  template <class Allowed>
  Candidate best(const Allowed& allowed) const {
    Candidate best;
    const int side = 2 * kReach + 1;
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        float xx = 0, xy = 0, yy = 0;
        for (int dy = 0; dy < side; ++dy) {
          const auto i = static_cast<std::size_t>((y + dy) * width_ + x);
          xx += rows_[0][i];
          xy += rows_[1][i];
          yy += rows_[2][i];
        }
        // The smaller eigenvalue of (xx xy; xy yy).
        const float d = 0.5F * (xx - yy);
        const float least = 0.5F * (xx + yy) - std::sqrt(d * d + xy * xy);
        // The eigenvalue first: `allowed` looks at all corners there are.
        if (least <= best.score || !allowed(x0_ + x, y0_ + y)) continue;
        best = {{static_cast<float>(x0_ + x), static_cast<float>(y0_ + y)}, least};
      }
    }
    // A mean over the window, as min_eigenvalue is.
    best.score /= static_cast<float>(side * side);
    return best;
  }

 private:
  void gradients() {
    wide_ = width_ + 2 * kReach;
    const int tall = height_ + 2 * kReach;
    for (auto& p : products_) p.resize(static_cast<std::size_t>(wide_ * tall));
    for (int y = 0; y < tall; ++y) {
      const int row = y0_ - kReach + y;
      const std::uint8_t* a = image_.row(row) + x0_ - kReach;
      const std::uint8_t *up = image_.row(row - 1) + x0_ - kReach,
                         *down = image_.row(row + 1) + x0_ - kReach;
      for (int x = 0; x < wide_; ++x) {
        // Central differences; kBorder leaves room for the window and one pixel more.
        const float gx = 0.5F * static_cast<float>(a[x + 1] - a[x - 1]);
        const float gy = 0.5F * static_cast<float>(down[x] - up[x]);
        const auto i = static_cast<std::size_t>(y * wide_ + x);
        products_[0][i] = gx * gx;
        products_[1][i] = gx * gy;
        products_[2][i] = gy * gy;
      }
    }
  }

  void sumRows() {
    const int tall = height_ + 2 * kReach;
    for (std::size_t c = 0; c < 3; ++c) {
      rows_[c].resize(static_cast<std::size_t>(width_ * tall));
      for (int y = 0; y < tall; ++y) {
        const float* p = products_[c].data() + y * wide_;
        float* r = rows_[c].data() + y * width_;
        for (int x = 0; x < width_; ++x) {
          r[x] = p[x] + p[x + 1] + p[x + 2] + p[x + 3] + p[x + 4] + p[x + 5] + p[x + 6];
        }
      }
    }
  }

  const GrayImageView& image_;
  int x0_, y0_, width_, height_, wide_ = 0;
  std::array<std::vector<float>, 3> products_, rows_;
};

}  // namespace

void CornerPickerOptions::check() const {
  requireOption(cell_px >= 8, "cell_px", cell_px, "8 or more");
  requireAtLeast(0, "min_distance_px", min_distance_px);
  requirePositive("min_eigenvalue", min_eigenvalue);
}

std::vector<Eigen::Vector2f> pickCorners(const GrayImageView& image,
                                         const std::vector<Eigen::Vector2f>& taken,
                                         const CornerPickerOptions& options) {
  std::vector<Eigen::Vector2f> all = taken;
  std::vector<Candidate> found;
  const auto least2 = static_cast<float>(options.min_distance_px * options.min_distance_px);
  for (int y0 = kBorder; y0 < image.height - kBorder; y0 += options.cell_px) {
    const int y1 = std::min(y0 + options.cell_px, image.height - kBorder);
    for (int x0 = kBorder; x0 < image.width - kBorder; x0 += options.cell_px) {
      const int x1 = std::min(x0 + options.cell_px, image.width - kBorder);
      const bool occupied = std::any_of(all.begin(), all.end(), [&](const Eigen::Vector2f& p) {
        return p.x() >= static_cast<float>(x0) && p.x() < static_cast<float>(x1) &&
               p.y() >= static_cast<float>(y0) && p.y() < static_cast<float>(y1);
      });
      // Before any gradient: a cell that is tracked costs nothing.
      if (occupied) continue;
      const Candidate best = CellSearch(image, x0, y0, x1, y1).best([&](int x, int y) {
        const Eigen::Vector2f at(static_cast<float>(x), static_cast<float>(y));
        return std::none_of(all.begin(), all.end(), [&](const Eigen::Vector2f& p) {
          return (p - at).squaredNorm() < least2;
        });
      });
      if (!(best.score > options.min_eigenvalue)) continue;
      found.push_back(best);
      // So that corners of neighbouring cells keep their distance, too.
      all.push_back(best.at);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Eigen::Vector2f> picked;
  for (const Candidate& c : found) picked.push_back(c.at);
  return picked;
}

}  // namespace plumbline
