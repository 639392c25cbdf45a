// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to the score tests: where the faults are that happen at some instant or frequency.

#include <vector>

#include "calibrator/batch/camera_imu/effective_terms.h"
#include "calibrator/linear/block_arrow.h"

namespace plumbline {

/// The frequency [Hz] of the largest periodogram of the forces left over, in F. It is looked for in
/// the residuals as they are: what the states absorb of a sine changes its size, not its frequency.
double swayFrequency(const CameraImuProblem& problem, const CameraImuSolution& solution);

/// Instants of the links where a jump explains most, camera clock.
struct JumpPlaces {
  TimeNs gyro_at = 0, accel_at = 0, target_at = 0;
  /// What a displacement of the target explains in one link of twenty, over what it would by
  /// chance: large where every link has residuals of its own.
  double target_dispersion = 1;
};

/// Puts the jumps' columns into the links that they explain best: the largest
///   s' A^-1 s,   s = C' r,   A = C' (1 - J S J') C,
/// C what the jump adds to the link's whitened residual r, J its Jacobian and S the covariance of
/// states and border.
JumpPlaces placeJumps(const CameraImuProblem& problem, const FaultColumns& columns,
                      const ChainCovariance& S, std::vector<LinkTerms>& links);

}  // namespace plumbline
