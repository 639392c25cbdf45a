// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/batch/camera_imu_problem.h"

namespace plumbline {

/// Kalibr's filter: rejects corners of the views of `frames` whose error, with only the view's pose
/// free, is above mean + 2 std of the view's errors and above 0.2 px. Returns how many.
std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners,
                             const std::vector<CameraCalibration>& cameras,
                             const std::vector<Frame>& frames, int threads);

/// Rejects corners of the problem's frames with |e| above `sigmas` times their camera's RMS per
/// axis, sqrt(mean |e|^2 / 2) over used corners, at the estimate. Returns how many.
std::size_t rejectAboveSigma(CameraImuProblem& problem, const CameraImuEstimate& estimate,
                             double sigmas);

}  // namespace plumbline
