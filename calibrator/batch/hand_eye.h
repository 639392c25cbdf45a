// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "calibrator/base/error.h"
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

struct HandEyeOptions {
  double sigma_m = 0;          ///< noise of a pair's positions, per axis [m]; 0: from the residuals
  double sigma_rad = 0;        ///< noise of a pair's rotations, per axis [rad]; 0: the same
  bool with_offset = false;    ///< whether the clock offset is unknown too
  double min_turn_rad = 0.03;  ///< spread of the rotations across the axis they share most (RMS)
                               ///< below which the translation along that axis is not claimed

  void check() const;  ///< throws InputError for a negative or infinite field
};

/// Marker body M in body S, and the two worlds, from pairs of poses.
struct HandEye {
  HandEyeState state;
  /// Of (T_SM: dt, da; T_VW: dt, da; offset [s] if with_offset), 12 or 13 square, tangents of
  /// Transform: (J^T W J)^-1 with W from the noise, times chi-square over its degrees of freedom.
  /// The noise is taken as white from pair to pair. An estimator's drift is not: its covariance is
  /// then too small, by about the square root of the pairs within the drift's correlation time.
  Eigen::MatrixXd covariance;
  double sigma_m = 0, sigma_rad = 0;  ///< noise the weights stood on
  double rms_translation_m = 0;       ///< of the residual's norm
  double rms_rotation_rad = 0;
  std::size_t pairs = 0;
};

/// Minimises sum |r_t|^2 / sigma_m^2 + |r_a|^2 / sigma_rad^2 of handEyeResidual: a start from
/// rotations alone (Kabsch over relative rotation vectors) and linear translations, then
/// minimise(); noise that is not given is estimated from the residuals of the solution before, four
/// times over.
///
/// Fails with kHandEyeTooFewPairs for fewer than 10; with kHandEyeOneAxis, naming it, where S turns
/// about one axis only (the translation of M along it then goes unseen), with kHandEyeNoRotation
/// where not at all; with kHandEyeRotationsDisagree where no T_SM explains the rotations within 20
/// degrees (RMS), as when one side's quaternions are inverted; with kHandEyePositionsDisagree where
/// what is left exceeds a quarter of the positions' spread; with kHandEyeNotConverged where
/// minimise() finds no minimum. O(pairs).
Result<HandEye> estimateHandEye(std::span<const HandEyePair> pairs,
                                const HandEyeOptions& options = {});

}  // namespace plumbline
