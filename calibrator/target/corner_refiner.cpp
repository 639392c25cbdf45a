// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/corner_refiner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calibrator/target/tag_image.h"

namespace plumbline {
namespace {

/// Pixels around a patch that its derivatives look at.
constexpr int kMargin_px = 2;
constexpr int kMaxIterations = 15;
constexpr double kConverged_px = 0.003;
/// Beyond any image; what a degenerate map of the grid predicts may be longer.
constexpr double kLongestAxis_px = 1e5;

/// Sectors as a saddle has them: inside the tag and across dark, the other two light, each dark one
/// darker than each light one by a share of the whole contrast.
bool looksLikeCorner(const GrayImageView& image, const Eigen::Matrix2d& axes,
                     const Eigen::Vector2d& p) {
  const auto [dark, light] = sectorLevels(image, axes, p);
  const double gap = std::min(light[0], light[1]) - std::max(dark[0], dark[1]);
  const double whole = std::max(light[0], light[1]) - std::min(dark[0], dark[1]);
  return gap > 0.25 * whole && gap > 5;
}

}  // namespace

CornerRefiner::Patch CornerRefiner::within(const Patch& patch, const Eigen::Vector2d& centre,
                                           const Eigen::Vector2d& reach) {
  Patch out;
  out.x0 = std::max(patch.x0, static_cast<int>(std::ceil(centre.x() - reach.x())));
  out.y0 = std::max(patch.y0, static_cast<int>(std::ceil(centre.y() - reach.y())));
  const int x1 = std::min(patch.x0 + patch.width - 1, static_cast<int>(centre.x() + reach.x()));
  const int y1 = std::min(patch.y0 + patch.height - 1, static_cast<int>(centre.y() + reach.y()));
  out.width = x1 - out.x0 + 1;
  out.height = y1 - out.y0 + 1;
  return out;
}

void CornerRefiner::fillGradients(const GrayImageView& image, const Patch& patch) {
  // Smoothing (1, 4, 6, 4, 1) across and difference (-1, -2, 0, 2, 1) along, separated: the
  // vertical part of both first, for each column of the patch and two beside it.
  const std::size_t width = static_cast<std::size_t>(patch.width);
  const std::size_t count = width * static_cast<std::size_t>(patch.height);
  gx_.resize(count);
  gy_.resize(count);
  smooth_.resize(width + 2 * kMargin_px);
  slope_.resize(width + 2 * kMargin_px);
  for (int y = 0; y < patch.height; ++y) {
    const int v = patch.y0 + y;
    const std::uint8_t* row[5];
    for (int i = 0; i < 5; ++i) row[i] = image.row(v + i - 2) + patch.x0 - kMargin_px;
    for (std::size_t x = 0; x < smooth_.size(); ++x) {
      smooth_[x] =
          static_cast<float>(row[0][x] + row[4][x] + 4 * (row[1][x] + row[3][x]) + 6 * row[2][x]);
      slope_[x] = static_cast<float>(row[4][x] - row[0][x] + 2 * (row[3][x] - row[1][x]));
    }
    float* gx = gx_.data() + static_cast<std::size_t>(y) * width;
    float* gy = gy_.data() + static_cast<std::size_t>(y) * width;
    const float* s = smooth_.data();
    const float* d = slope_.data();
    for (std::size_t x = 0; x < width; ++x) {
      gx[x] = s[x + 4] - s[x] + 2 * (s[x + 3] - s[x + 1]);
      gy[x] = d[x] + d[x + 4] + 4 * (d[x + 1] + d[x + 3]) + 6 * d[x + 2];
    }
  }
}

std::optional<Eigen::Vector2d> CornerRefiner::step(const Patch& patch, const Window& window,
                                                   const Eigen::Vector2d& p) const {
  const auto m00 = static_cast<float>(window.inverse_shape(0, 0));
  const auto m01 = static_cast<float>(window.inverse_shape(0, 1) + window.inverse_shape(1, 0));
  const auto m11 = static_cast<float>(window.inverse_shape(1, 1));
  const Patch part = within(patch, p, window.reach);
  float xx = 0, xy = 0, yy = 0, bx = 0, by = 0;
  for (int y = 0; y < part.height; ++y) {
    const auto dy = static_cast<float>(part.y0 + y - p.y());
    const auto left = static_cast<float>(part.x0 - p.x());
    const int first = (part.y0 + y - patch.y0) * patch.width + part.x0 - patch.x0;
    const float* gx = gx_.data() + first;
    const float* gy = gy_.data() + first;
    for (int x = 0; x < part.width; ++x) {
      const float dx = left + static_cast<float>(x);
      // Squared, it falls to zero at the rim with a slope of zero: pixels that come and go as p
      // moves change the sums smoothly.
      const float inside = std::max(0.0F, 1 - (m00 * dx * dx + m01 * dx * dy + m11 * dy * dy));
      const float w = inside * inside;
      const float wx = w * gx[x];
      const float wy = w * gy[x];
      const float along = gx[x] * dx + gy[x] * dy;
      xx += wx * gx[x];
      xy += wx * gy[x];
      yy += wy * gy[x];
      bx += wx * along;
      by += wy * along;
    }
  }
  // Normal equations of min sum w (g . (x - p - d))^2: [sum w g g'] d = sum w g (g . (x - p)).
  const double det = static_cast<double>(xx) * yy - static_cast<double>(xy) * xy;
  const double trace = static_cast<double>(xx) + yy;
  if (!(det > 0.01 * trace * trace)) return std::nullopt;  // gradients of one direction only
  return Eigen::Vector2d((yy * bx - xy * by) / det, (xx * by - xy * bx) / det);
}

std::optional<Eigen::Vector2d> CornerRefiner::refine(const GrayImageView& image,
                                                     const CornerWindow& window) {
  if (!isInside(window.start, {image.width, image.height}) || !window.axes.allFinite()) {
    return std::nullopt;
  }
  const Eigen::Matrix2d axes = window.axes.cwiseMax(-kLongestAxis_px).cwiseMin(kLongestAxis_px);
  const Eigen::Matrix2d shape = ellipseOf(axes);
  const Window ellipse{shape.inverse(), shape.diagonal().cwiseSqrt()};
  const Patch whole{kMargin_px, kMargin_px, image.width - 2 * kMargin_px,
                    image.height - 2 * kMargin_px};
  // Gradients once, for wherever the window may move.
  const Eigen::Vector2d reach = ellipse.reach.array() + window.max_shift_px;
  const Patch patch = within(whole, window.start, reach);
  if (patch.empty()) return std::nullopt;
  fillGradients(image, patch);
  Eigen::Vector2d p = window.start;
  bool converged = false;
  for (int iteration = 0; iteration < kMaxIterations && !converged; ++iteration) {
    const std::optional<Eigen::Vector2d> delta = step(patch, ellipse, p);
    if (!delta) return std::nullopt;
    p += *delta;
    if (!((p - window.start).norm() <= window.max_shift_px)) return std::nullopt;
    converged = delta->norm() < kConverged_px;
  }
  if (!converged || !looksLikeCorner(image, window.axes, p)) return std::nullopt;
  return p;
}

}  // namespace plumbline
