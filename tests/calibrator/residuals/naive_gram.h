// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline::test {

/// The Gram matrix of one view, corner by corner with dense rows: slow, and plain to see.
/// Order of the parameters: twist (6), intrinsics (8).
struct NaiveGram {
  Eigen::Matrix<double, 14, 14> H = Eigen::Matrix<double, 14, 14>::Zero();
  Eigen::Matrix<double, 14, 1> b = Eigen::Matrix<double, 14, 1>::Zero();
  double squared_error = 0;
  double cost = 0;
};

/// The 2x2 weight of an error under the options (see GramOptions), built from its eigenvectors.
inline Eigen::Matrix2d naiveWeight(const Eigen::Vector2d& e, const GramOptions& options) {
  if (options.cauchy_px == 0 || e.norm() == 0) return Eigen::Matrix2d::Identity();
  const double s = e.squaredNorm() / (options.cauchy_px * options.cauchy_px);
  const double beta = std::min(2 * s / (1 + s), options.triggs_clamp);
  const Eigen::Vector2d n = e.normalized();
  return (Eigen::Matrix2d::Identity() - beta * n * n.transpose()) / (1 + s);
}

inline NaiveGram naiveGram(const Intrinsics& camera, const Transform& T_CF, const AprilGrid& target,
                           const PackedView& view, const GramOptions& options) {
  NaiveGram gram;
  for (int i = 0; i < view.count; ++i) {
    if (view.w[i] == 0) continue;
    const Eigen::Vector2d p_F = target.corner(view.id[i]);
    const Eigen::Vector3d p_C = T_CF * Eigen::Vector3d(p_F.x(), p_F.y(), 0);
    const Projection projection = projectWithJacobians(camera, p_C).value();
    const Eigen::Vector2d e = projection.uv - Eigen::Vector2d(view.u[i], view.v[i]);
    Eigen::Matrix<double, 2, 14> J;
    J << projection.J_point, -projection.J_point * skew(p_C), projection.J_intrinsics;
    const double c2 = options.cauchy_px * options.cauchy_px;
    const double slope = c2 > 0 ? 1 / (1 + e.squaredNorm() / c2) : 1.0;
    gram.H += J.transpose() * naiveWeight(e, options) * J;
    gram.b += slope * J.transpose() * e;
    gram.squared_error += e.squaredNorm();
    gram.cost += c2 > 0 ? c2 * std::log1p(e.squaredNorm() / c2) : e.squaredNorm();
  }
  return gram;
}

}  // namespace plumbline::test
