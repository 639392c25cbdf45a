// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/linear/dense.h"

namespace plumbline {

/// The chain's terms on its first blocks 0 .. count, and the border, with blocks 0 .. count - 1
/// eliminated one after the other (marginalised()): a cost of (block `count` (15), border). What
/// the chain holds after block `count` is left out. Empty where a block eliminated is not
/// determined.
std::optional<QuadraticCost> frontEliminated(const BlockArrow& chain, int count);

/// What frames that have left a window say of the state that follows them and of the calibration: a
/// quadratic cost of the displacement (state (15), T_SC0 (6), gravity's direction (2), time offset
/// (1)) from the point where their terms were linearised. Displacements are those of the tangents:
/// boxminus() of poses, angles along tangentBasis() of the gravity of that point.
///
/// The terms dropped stay linearised where they were (their Jacobians are not renewed); the prior's
/// gradient follows the estimate, b + H d. Measurements that come later are linearised at the
/// newest estimate. In a map that floats freely, such a mixture would invent knowledge of its
/// gauge, and first estimates of what the prior touches would have to be kept for all Jacobians.
/// Here every state stands in the target's frame, which the corners fix, and gravity's direction is
/// estimated with them: no gauge freedom remains that could be lost, and what is left is the error
/// of second order of any linearisation. It is kept small by a start from a batch and by
/// linearising a frame when it leaves, at its best estimate.
struct CameraImuPrior {
  QuadraticCost cost;
  ImuState state;
  Transform T_SC0;
  Eigen::Vector3d gravity_direction = -Eigen::Vector3d::UnitZ();
  double time_offset_s = 0;

  /// The first state of an estimate and its calibration, as a displacement from the prior's point.
  Eigen::VectorXd displacement(const CameraImuEstimate& estimate) const;
  /// c + b' d + 0.5 d' H d.
  double costAt(const CameraImuEstimate& estimate) const;
  /// Adds the prior's normal equations and cost to those of a chain that begins with its state.
  void addTo(const CameraImuEstimate& estimate, CameraImuNormals& normals) const;
};

/// All terms of the problem's first `count` frames (their corners, the links after them, and the
/// prior on the first state, if there is one) as a prior on the frame after them. Weights of
/// information are used (informationAt()), so that the loss counts by re-weighted squares. The
/// problem's cameras are fixed. Empty where the frames dropped are not determined or left the IMU
/// samples.
std::optional<CameraImuPrior> marginaliseFront(const CameraImuProblem& problem,
                                               const CameraImuEstimate& estimate,
                                               const ImuWeights& weights,
                                               const std::optional<CameraImuPrior>& prior,
                                               int count);

}  // namespace plumbline
