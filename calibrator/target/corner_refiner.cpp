// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/corner_refiner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calibrator/target/payload.h"

namespace plumbline {
namespace {

/// Pixels around a patch that its derivatives look at.
constexpr int kMargin_px = 2;
constexpr int kMaxIterations = 15;
constexpr double kConverged_px = 0.003;
/// The window is never thinner than this, so that it holds gradients at all [px].
constexpr double kMinRadius_px = 2.0;

/// Sectors as a saddle has them: inside the tag and across dark, the other two light, each dark one
/// darker than each light one by a share of the whole contrast.
bool looksLikeCorner(const GrayImageView& image, const Eigen::Matrix2d& axes,
                     const Eigen::Vector2d& p) {
  constexpr double kReach = 0.55;  // of the window: clear of the blurred edges, short of its end
  const auto gray = [&](double a, double b) {
    return sampleBilinear(image, p + axes * Eigen::Vector2d(a * kReach, b * kReach));
  };
  const double dark[] = {gray(-1, -1), gray(1, 1)};
  const double light[] = {gray(1, -1), gray(-1, 1)};
  const double gap = std::min(light[0], light[1]) - std::max(dark[0], dark[1]);
  const double whole = std::max(light[0], light[1]) - std::min(dark[0], dark[1]);
  return gap > 0.25 * whole && gap > 5;
}

}  // namespace

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

std::optional<Eigen::Vector2d> CornerRefiner::step(const Patch& patch,
                                                   const Eigen::Matrix2d& inverse_shape,
                                                   const Eigen::Vector2d& p) const {
  const auto m00 = static_cast<float>(inverse_shape(0, 0));
  const auto m01 = static_cast<float>(inverse_shape(0, 1) + inverse_shape(1, 0));
  const auto m11 = static_cast<float>(inverse_shape(1, 1));
  float xx = 0, xy = 0, yy = 0, bx = 0, by = 0;
  std::size_t i = 0;
  for (int y = 0; y < patch.height; ++y) {
    const auto dy = static_cast<float>(patch.y0 + y - p.y());
    const auto left = static_cast<float>(patch.x0 - p.x());
    for (int x = 0; x < patch.width; ++x, ++i) {
      const float dx = left + static_cast<float>(x);
      const float inside = std::max(0.0F, 1 - (m00 * dx * dx + m01 * dx * dy + m11 * dy * dy));
      const float w = inside * inside;
      const float wx = w * gx_[i];
      const float wy = w * gy_[i];
      const float along = gx_[i] * dx + gy_[i] * dy;
      xx += wx * gx_[i];
      xy += wx * gy_[i];
      yy += wy * gy_[i];
      bx += wx * along;
      by += wy * along;
    }
  }
  const double det = static_cast<double>(xx) * yy - static_cast<double>(xy) * xy;
  const double trace = static_cast<double>(xx) + yy;
  if (!(det > 0.01 * trace * trace)) return std::nullopt;  // gradients of one direction only
  return Eigen::Vector2d((yy * bx - xy * by) / det, (xx * by - xy * bx) / det);
}

std::optional<Eigen::Vector2d> CornerRefiner::refine(const GrayImageView& image,
                                                     const CornerWindow& window) {
  const bool inside = window.start.x() >= 0 && window.start.y() >= 0 &&
                      window.start.x() <= image.width - 1 && window.start.y() <= image.height - 1;
  if (!inside) return std::nullopt;
  const Eigen::Matrix2d shape = window.axes * window.axes.transpose() +
                                kMinRadius_px * kMinRadius_px * Eigen::Matrix2d::Identity();
  const double reach_x = std::sqrt(shape(0, 0)) + window.max_shift_px;
  const double reach_y = std::sqrt(shape(1, 1)) + window.max_shift_px;
  Patch patch;
  patch.x0 = std::max(kMargin_px, static_cast<int>(std::ceil(window.start.x() - reach_x)));
  patch.y0 = std::max(kMargin_px, static_cast<int>(std::ceil(window.start.y() - reach_y)));
  patch.width =
      std::min(image.width - 1 - kMargin_px, static_cast<int>(window.start.x() + reach_x)) -
      patch.x0 + 1;
  patch.height =
      std::min(image.height - 1 - kMargin_px, static_cast<int>(window.start.y() + reach_y)) -
      patch.y0 + 1;
  if (patch.empty()) return std::nullopt;
  fillGradients(image, patch);
  const Eigen::Matrix2d inverse_shape = shape.inverse();
  Eigen::Vector2d p = window.start;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const std::optional<Eigen::Vector2d> delta = step(patch, inverse_shape, p);
    if (!delta) return std::nullopt;
    p += *delta;
    if (!((p - window.start).norm() <= window.max_shift_px)) return std::nullopt;
    if (delta->norm() < kConverged_px) break;
  }
  if (!looksLikeCorner(image, window.axes, p)) return std::nullopt;
  return p;
}

}  // namespace plumbline
