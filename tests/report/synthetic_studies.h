// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/records/comparison_record.h"
#include "report/records/perturbation_record.h"
#include "report/records/trajectory_record.h"

namespace plumbline::test {

/// 21 moved IMU stamps of which the last fails, two target sizes, three draws of corner noise; no
/// two numbers are the same.
PerturbationRecord syntheticPerturbation();

/// Two sequences, two calibrations, three runs each: one failed, one partial; "b" is worse by a
/// quarter. The first run carries clock offset, hand-eye and NEES.
TrajectoryRecord syntheticTrajectories();

/// Three calibrations of two cameras: the second's `fu` is 10 sigma off, the third has no IMU and
/// states no deviations; scores, maps with undefined corners, and the trajectories.
ComparisonRecord syntheticComparison();

}  // namespace plumbline::test
