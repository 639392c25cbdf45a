// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/local_map.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace plumbline {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// 1, x, y, x x, x y, y y: summed over points, their number and first and second moments.
Vector6 products(const Eigen::Vector2d& p) {
  Vector6 m;
  m << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
  return m;
}

struct LinePoint {
  Eigen::Vector2d d;                 ///< relative to the centre, in units of the radius
  std::array<std::size_t, 2> lines;  ///< along x and along y, that the corner lies on
};

/// Every row of tags has two lines, along the bottoms and the tops of its tags; behind those every
/// column has two, along their left and right edges.
std::vector<LinePoint> linePoints(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                  const DivisionDistortion& distortion) {
  std::vector<LinePoint> points;
  for (const TagImage& tag : tags) {
    const std::size_t row = tag.id / grid.cols, col = grid.rows + tag.id % grid.cols;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!tag.located[k]) continue;
      points.push_back({(tag.uv[k] - distortion.centre) / distortion.radius,
                        {2 * row + (k >= 2 ? 1 : 0), 2 * col + (k == 1 || k == 2 ? 1 : 0)}});
    }
  }
  return points;
}

/// See estimateDistortion(): the share of the squared lengths that lies across the lines; infinite
/// where no line counts.
double bending(const AprilGrid& grid, const std::vector<LinePoint>& points, double lambda) {
  std::vector<Vector6> lines(2 * (grid.rows + grid.cols), Vector6::Zero());
  for (const LinePoint& point : points) {
    const Vector6 m = products(point.d / (1 + lambda * point.d.squaredNorm()));
    for (const std::size_t line : point.lines) lines[line] += m;
  }
  double across = 0, along = 0;
  for (const Vector6& m : lines) {
    if (m[0] < 4) continue;  // two tags: their four points
    const double xx = m[3] - m[1] * m[1] / m[0];
    const double xy = m[4] - m[1] * m[2] / m[0];
    const double yy = m[5] - m[2] * m[2] / m[0];
    // The eigenvalues of the scatter are (xx + yy -+ spread) / 2: least squares across and along.
    const double spread = std::hypot(xx - yy, 2 * xy);
    across += std::max(0.0, 0.5 * (xx + yy - spread));
    along += 0.5 * (xx + yy + spread);
  }
  return along > 0 ? across / along : HUGE_VAL;
}

}  // namespace

Eigen::Vector2d DivisionDistortion::straighten(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d d = (uv - centre) / radius;
  return centre + radius / (1 + lambda * d.squaredNorm()) * d;
}

Eigen::Vector2d DivisionDistortion::distort(const Eigen::Vector2d& straight) const {
  // With s and d the lengths before and after: lambda s d^2 - d + s = 0; the root that is s at 0.
  const Eigen::Vector2d s = (straight - centre) / radius;
  // Written as 2 s / (1 + root), which does not cancel for a small lambda. Beyond the largest s
  // that the model reaches the root is taken as 0.
  const double root = std::sqrt(std::max(0.0, 1 - 4 * lambda * s.squaredNorm()));
  return centre + radius * 2 / (1 + root) * s;
}

DivisionDistortion estimateDistortion(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                      const Resolution& resolution, std::size_t min_tags) {
  DivisionDistortion distortion;
  distortion.centre = {0.5 * (resolution.width - 1), 0.5 * (resolution.height - 1)};
  distortion.radius = 0.5 * std::hypot(resolution.width, resolution.height);
  if (tags.size() < min_tags) return distortion;
  const std::vector<LinePoint> points = linePoints(grid, tags, distortion);
  double furthest = 1e-3;
  for (const LinePoint& p : points) furthest = std::max(furthest, p.d.squaredNorm());
  // The model needs 1 + lambda |d|^2 > 0; pincushion beyond 0.5 does not occur.
  double low = std::max(-4.0, -0.9 / furthest);
  double high = 0.5;
  constexpr int kSamples = 9;  // each round keeps the two intervals around the best sample
  for (int round = 0; round < 5; ++round) {
    const double step = (high - low) / (kSamples - 1);
    int best = 0;
    double least = HUGE_VAL;
    for (int i = 0; i < kSamples; ++i) {
      const double value = bending(grid, points, low + i * step);
      if (value < least) {
        least = value;
        best = i;
      }
    }
    if (!(least < HUGE_VAL)) return distortion;
    const double middle = low + best * step;
    low = std::max(-0.99 / furthest, middle - step);  // nearer to the pole, but not beyond it
    high = middle + step;
  }
  distortion.lambda = 0.5 * (low + high);
  return distortion;
}

namespace {

using Vector8 = Eigen::Matrix<double, 8, 1>;
using Matrix8 = Eigen::Matrix<double, 8, 8>;

/// Tags further than this many rows or columns from the place asked for are not heard.
constexpr int kHeardTags = 2;

/// Weighted normal equations of u = (h0 + h1 x + h2 y) / (1 + h6 x + h7 y), v likewise with h3, h4,
/// h5, multiplied out: with X = (1, x, y) and Y = (x, y) the rows (X, 0, -u Y) h = u and
/// (0, X, -v Y) h = v; (x, y) relative to the place asked for, where the denominator is 1. All
/// their entries are sums of few products, which are gathered instead.
class HomographyFit {
 public:
  void add(const Eigen::Vector2d& xy, const Eigen::Vector2d& uv, double weight) {
    const Eigen::RowVector4d weights(1, uv.x(), uv.y(), uv.squaredNorm());
    sums_.noalias() += products(xy).lazyProduct(weight * weights);
  }

  Matrix8 normal() const {
    Matrix8 A = Matrix8::Zero();
    A.topLeftCorner<3, 3>() = A.block<3, 3>(3, 3) = secondMoments(0);
    A.block<2, 3>(6, 0) = -secondMoments(1).bottomRows<2>();
    A.block<2, 3>(6, 3) = -secondMoments(2).bottomRows<2>();
    A.bottomRightCorner<2, 2>() = secondMoments(3).bottomRightCorner<2, 2>();
    return A.selfadjointView<Eigen::Lower>();
  }

  Vector8 right() const {
    Vector8 b;
    b << sums_.col(1).head<3>(), sums_.col(2).head<3>(), -sums_.col(3).segment<2>(1);
    return b;
  }

 private:
  /// Sum of (1, x, y) (1, x, y)' under one of the weights.
  Eigen::Matrix3d secondMoments(int weight) const {
    const auto m = sums_.col(weight);
    Eigen::Matrix3d M;
    M << m(0), m(1), m(2), m(1), m(3), m(4), m(2), m(4), m(5);
    return M;
  }

  /// 1, x, y, x x, x y, y y times 1, u, v, u u + v v.
  Eigen::Matrix<double, 6, 4> sums_ = Eigen::Matrix<double, 6, 4>::Zero();
};

}  // namespace

LocalMap::LocalMap(const AprilGrid& grid, const std::vector<TagImage>& tags,
                   const Resolution& resolution)
    : grid_(grid), distortion_(estimateDistortion(grid, tags, resolution)) {
  for (const TagImage& tag : tags) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (!tag.located[k]) continue;
      points_.push_back(
          {tag.id, tag.id / grid.cols, tag.id % grid.cols,
           grid.corner(4 * tag.id + static_cast<int>(k)) / grid.pitch(),
           (distortion_.straighten(tag.uv[k]) - distortion_.centre) / distortion_.radius});
    }
  }
}

std::optional<Eigen::Vector2d> LocalMap::predict(int corner_id, int left_out) const {
  const Eigen::Vector2d place = grid_.corner(corner_id) / grid_.pitch();
  const int col = corner_id / 4 % grid_.cols;
  const int row = corner_id / 4 / grid_.cols;
  HomographyFit fit;
  int heard = 0;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  for (const Point& point : points_) {
    if (point.tag_id == left_out || std::abs(point.col - col) > kHeardTags ||
        std::abs(point.row - row) > kHeardTags) {
      continue;
    }
    // Straightened places relative to one nearby: the products of the normal equations lose less.
    if (heard == 0) origin = point.straight;
    const Eigen::Vector2d xy = point.on_grid - place;
    // In pitches. The corners beside the place count about a hundred times as much as those a pitch
    // away; the constant keeps them finite.
    const double near = 0.1 + xy.squaredNorm();
    fit.add(xy, point.straight - origin, 1 / (near * near));
    ++heard;
  }
  // Eight unknowns, two rows a corner.
  if (heard < 4) return std::nullopt;
  const auto factor = fit.normal().ldlt();
  const Vector8 h = factor.solve(fit.right());
  if (factor.info() != Eigen::Success || !h.allFinite() || !(factor.rcond() > 1e-12)) {
    return std::nullopt;
  }
  const Eigen::Vector2d straight = origin + Eigen::Vector2d(h[0], h[3]);
  return distortion_.distort(distortion_.centre + distortion_.radius * straight);
}

}  // namespace plumbline
