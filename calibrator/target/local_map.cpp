// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/local_map.h"

#include <Eigen/Cholesky>
#include <cstdlib>

namespace plumbline {
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
    sums_.noalias() += moments(xy).lazyProduct(weight * weights);
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
