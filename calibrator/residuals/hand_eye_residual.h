// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/transform.h"

namespace plumbline {

/// One motion seen twice: body S in world W (an estimate) and body M in world V (motion capture),
/// with M's velocity there, for a clock offset.
struct HandEyePair {
  Transform T_WS, T_VM;
  Eigen::Vector3d v_V = Eigen::Vector3d::Zero();      ///< of M's origin in V [m/s]
  Eigen::Vector3d omega_V = Eigen::Vector3d::Zero();  ///< of M against V, in V [rad/s]
};

/// What joins the two: p_S = T_SM p_M, p_V = T_VW p_W, and t_truth = t_estimate + offset_s on top
/// of what the pairs were made with.
struct HandEyeState {
  Transform T_SM, T_VW;
  double offset_s = 0;
};

/// r = (P.t - t_VM(offset), Log(P.R R_VM(offset)^T)) [m, rad] with P = T_VW T_WS T_SM and the truth
/// carried on by its velocity: t_VM + offset v, Exp(offset omega) R_VM. Jacobians in the tangents
/// of Transform.
struct HandEyeResidual {
  Vector6d r = Vector6d::Zero();
  Matrix6d J_SM = Matrix6d::Zero();
  Matrix6d J_VW = Matrix6d::Zero();
  Vector6d J_offset = Vector6d::Zero();  ///< per second
};

/// Valid for rotations apart by less than pi; the offset is a small one, over which the velocity
/// changes little.
HandEyeResidual handEyeResidual(const HandEyePair& pair, const HandEyeState& state);

}  // namespace plumbline
