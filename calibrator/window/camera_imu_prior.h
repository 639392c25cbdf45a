// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/window/linear_prior.h"

namespace plumbline {

/// On the first state (15), T_SC0 (6), gravity's direction (2) and the time offset (1), in the
/// tangents of its point (gravity: angles along tangentBasis()), which has one state.
using CameraImuPrior = LinearPrior<CameraImuEstimate>;
Displacement displacementOf(const CameraImuEstimate& to, const CameraImuEstimate& from);

/// Adds the prior's normal equations and cost to those of a chain that begins with its state.
void addPrior(const CameraImuPrior& prior, const CameraImuEstimate& estimate,
              CameraImuNormals& normals);

/// The chain's terms on its first blocks 0 .. count, and the border, with blocks 0 .. count - 1
/// eliminated one after the other (marginalised()): a cost of (block `count` (15), border), whose
/// noise is that of `corners`, the corners' part of the chain. What the chain holds after block
/// `count` is left out. Empty where a block eliminated is not determined.
std::optional<QuadraticCost> frontEliminated(const BlockArrow& chain, const BlockArrow& corners,
                                             int count);

/// All that problem and prior (on the first state, if there is one) say of frame `count` and the
/// border, the frames before it eliminated (frontEliminated()), by informationAt(). Empty where
/// those are not determined or left the IMU samples.
std::optional<QuadraticCost> frontCost(const CameraImuProblem& problem,
                                       const CameraImuEstimate& estimate, const ImuWeights& weights,
                                       const std::optional<CameraImuPrior>& prior, int count);

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
