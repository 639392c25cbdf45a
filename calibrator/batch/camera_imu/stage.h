// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/camera_imu/frames.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/batch/camera_imu/solver.h"

namespace plumbline {

/// The session's measurements without frames: corners packed, stamps shifted, noise chosen.
CameraImuProblem makeProblem(const Session& session, const CameraImuOptions& options);

/// How frames are selected under a time offset, from the stage's options.
FrameSelectionOptions selectionOptions(const CameraImuOptions& options, double time_offset_s);

/// solveCameraImu() under the stage's options. With a robust loss the squared one goes first, for a
/// few steps (its normal equations lead closer to the minimum from afar), unless the start is a
/// solution already.
CameraImuSolution solveFrom(CameraImuProblem& problem, const CameraImuEstimate& start,
                            const CameraImuOptions& options);
CameraImuSolution solveFromSolution(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                    const CameraImuOptions& options);

/// Everything the stage reports of a solution but its seconds and what was left out before the
/// problem was made. Fails where the solver found nothing or the parameters are not observable.
Result<CameraImuStageResult> stageResult(const CameraImuProblem& problem,
                                         const CameraImuSolution& solution, const Session& session,
                                         const CameraImuOptions& options);

/// The same of a solution that holds the calibration: no covariance, no standard deviations. Fails
/// where the solver found nothing.
Result<CameraImuStageResult> scoreResult(const CameraImuProblem& problem,
                                         const CameraImuSolution& solution, const Session& session);

}  // namespace plumbline
