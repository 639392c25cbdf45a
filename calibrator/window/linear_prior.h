// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/linear/dense.h"

namespace plumbline {

/// Displacement of an estimate from another one, in the tangent of that one, and its derivative J
/// in the tangent of the estimate. Every kind of estimate has its displacementOf(to, from).
struct Displacement {
  Eigen::VectorXd d;
  Eigen::MatrixXd J;
};

/// What measurements that left a fixed-lag window still say of the parameters that stay: their cost
/// about the point at which they were linearised, all that left with them at its best
/// (marginalised()).
///   f(x) = c + b^T d + 0.5 d^T H d,   d = x (-) point  in the tangent of the point.
/// Source: Leutenegger et al., "Keyframe-based visual-inertial odometry using nonlinear
/// optimization", IJRR 2015, sec. 3.3.
///
/// First estimates. The derivatives in H and b stay those of the linearisation point for good;
/// terms still in the window are linearised where the estimate is now. In odometry that mixture
/// gives information in directions in which there is none (the gauge: position and yaw), unless all
/// terms take the derivatives of the first estimate. Calibration happens in the target's frame,
/// which the corners fix, and gravity's direction is estimated with the states: there is no gauge,
/// so no nullspace to protect, and the first-estimate rule is not applied to the terms in the
/// window: they are better where the estimate is better. What remains is the ordinary error of
/// linearising, of second order in d; it is kept small by a start from a batch and by linearising a
/// frame when it leaves, at its best estimate.
template <class Estimate>
struct LinearPrior {
  QuadraticCost cost;  ///< about `point`
  Estimate point;

  /// The same quadratic about an estimate, in the tangent of the estimate.
  QuadraticCost at(const Estimate& estimate) const {
    const Displacement x = displacementOf(estimate, point);
    return cost.at(x.d).through(x.J);
  }
};

}  // namespace plumbline
