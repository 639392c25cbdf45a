// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <utility>

#include "calibrator/linear/dense.h"

namespace plumbline {

/// What measurements that left a fixed-lag window still say of the parameters that stay: their cost
/// about the point at which they were linearised, all that left with them at its best
/// (marginalised() of calibrator/linear/schur.h).
///   f(x) = c + b^T d + 0.5 d^T H d,   d = x (-) x_lin  in the tangent of the linearisation point.
/// The point itself, and what (-) is for it, belong to who holds the prior. Source: Leutenegger et
/// al., "Keyframe-based visual-inertial odometry using nonlinear optimization", IJRR 2015,
/// sec. 3.3.
///
/// First estimates. The derivatives in H and b stay those of the linearisation point for good;
/// terms still in the window are linearised where the estimate is now. In odometry that mixture
/// gives information in directions in which there is none (the gauge: position and yaw), unless all
/// terms take the derivatives of the first estimate. Calibration happens in the target's frame,
/// which is known: there is no gauge, so no nullspace to protect, and the first-estimate rule is
/// not applied to the terms in the window: they are better where the estimate is better. What
/// remains is the ordinary error of linearising, of second order in d. Evaluated elsewhere, the
/// prior keeps H and moves its gradient by H d.
class LinearPrior {
 public:
  /// `at_linearisation`: value, gradient and curvature at x_lin.
  explicit LinearPrior(QuadraticCost at_linearisation) : cost_(std::move(at_linearisation)) {}
  /// Nothing is known of n parameters.
  explicit LinearPrior(Eigen::Index n)
      : cost_{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0} {}

  /// The same quadratic about the point at displacement d: value f(d), gradient b + H d, H.
  QuadraticCost at(const Eigen::VectorXd& d) const;

  Eigen::Index size() const { return cost_.b.size(); }

 private:
  QuadraticCost cost_;
};

}  // namespace plumbline
