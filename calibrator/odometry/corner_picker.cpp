// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/corner_picker.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

constexpr int kImageBorder = 12;  // [px]: the tracker's patch and its gradients fit
constexpr int kWindowReach = 3;   // of the 7 x 7 window

struct PickedCorner {
  Eigen::Vector2f at = Eigen::Vector2f::Zero();
  float score = 0;
};

/// A cell of the image.
struct Cell {
  int x0 = 0, y0 = 0, width = 0, height = 0;
};

/// The gradient's products xx, xy, yy, each summed over 7 pixels of a row: `width` values a row,
/// from kWindowReach rows above the cell to kWindowReach below it.
std::array<std::vector<float>, 3> rowSums(const GrayImageView& image, const Cell& cell) {
  const int tall = cell.height + 2 * kWindowReach, wide = cell.width + 2 * kWindowReach;
  std::array<std::vector<float>, 3> products, sums;
  for (auto& p : products) p.resize(wide);
  for (auto& s : sums) s.resize(cell.width * tall);
  for (int y = 0; y < tall; ++y) {
    const int left = cell.x0 - kWindowReach, row = cell.y0 - kWindowReach + y;
    const std::uint8_t* a = image.row(row) + left;
    const std::uint8_t *up = image.row(row - 1) + left, *down = image.row(row + 1) + left;
    for (int x = 0; x < wide; ++x) {
      // Central differences; kImageBorder leaves room for the window and one pixel more.
      const float gx = 0.5F * static_cast<float>(a[x + 1] - a[x - 1]);
      const float gy = 0.5F * static_cast<float>(down[x] - up[x]);
      products[0][x] = gx * gx;
      products[1][x] = gx * gy;
      products[2][x] = gy * gy;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const float* p = products[c].data();
      float* sum = sums[c].data() + y * cell.width;
      for (int x = 0; x < cell.width; ++x) {
        sum[x] = p[x] + p[x + 1] + p[x + 2] + p[x + 3] + p[x + 4] + p[x + 5] + p[x + 6];
      }
    }
  }
  return sums;
}

/// The best pixel of the cell that is `allowed`. The box of 7 x 7 is summed along rows
/// first, then down: about 14 additions a pixel for each moment in place of 49.
template <class Allowed>
PickedCorner bestIn(const GrayImageView& image, const Cell& cell, const Allowed& allowed) {
  const auto rows = rowSums(image, cell);
  constexpr int kWindow = 2 * kWindowReach + 1;
  PickedCorner best;
  for (int y = 0; y < cell.height; ++y) {
    for (int x = 0; x < cell.width; ++x) {
      float xx = 0, xy = 0, yy = 0;
      for (int dy = 0; dy < kWindow; ++dy) {
        const int i = (y + dy) * cell.width + x;
        xx += rows[0][i];
        xy += rows[1][i];
        yy += rows[2][i];
      }
      // The smaller eigenvalue of (xx xy; xy yy).
      const float d = 0.5F * (xx - yy);
      const float least = 0.5F * (xx + yy) - std::sqrt(d * d + xy * xy);
      // The eigenvalue first: `allowed` looks at all corners there are.
      if (least <= best.score) continue;
      const Eigen::Vector2f at(cell.x0 + x, cell.y0 + y);
      if (allowed(at)) best = {at, least};
    }
  }
  // A mean over the window, as min_eigenvalue is.
  best.score /= static_cast<float>(kWindow * kWindow);
  return best;
}

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
  std::vector<PickedCorner> found;
  const auto least2 = static_cast<float>(options.min_distance_px * options.min_distance_px);
  for (int y0 = kImageBorder; y0 < image.height - kImageBorder; y0 += options.cell_px) {
    const int y1 = std::min(y0 + options.cell_px, image.height - kImageBorder);
    for (int x0 = kImageBorder; x0 < image.width - kImageBorder; x0 += options.cell_px) {
      const int x1 = std::min(x0 + options.cell_px, image.width - kImageBorder);
      const bool occupied = std::any_of(all.begin(), all.end(), [&](const Eigen::Vector2f& p) {
        return p.x() >= x0 && p.x() < x1 && p.y() >= y0 && p.y() < y1;
      });
      // Before any gradient: a cell that is tracked costs nothing.
      if (occupied) continue;
      const auto allowed = [&](const Eigen::Vector2f& at) {
        return std::none_of(all.begin(), all.end(), [&](const Eigen::Vector2f& p) {
          return (p - at).squaredNorm() < least2;
        });
      };
      const PickedCorner best = bestIn(image, {x0, y0, x1 - x0, y1 - y0}, allowed);
      if (!(best.score > options.min_eigenvalue)) continue;
      found.push_back(best);
      // So that corners of neighbouring cells keep their distance, too.
      all.push_back(best.at);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const PickedCorner& a, const PickedCorner& b) { return a.score > b.score; });
  std::vector<Eigen::Vector2f> picked;
  for (const PickedCorner& c : found) picked.push_back(c.at);
  return picked;
}

}  // namespace plumbline
