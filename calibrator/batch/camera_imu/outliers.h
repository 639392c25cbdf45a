// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

/// CornerFilter::kKalibr (see kalibrOutliers()) for the views of `frames`, each from its own
/// homography. Returns how many corners it rejected.
std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners,
                             const std::vector<CameraCalibration>& cameras,
                             const std::vector<Frame>& frames, int threads);

/// CornerFilter::kSigma (see rejectAboveSigma() of corner_outliers.h) over all cameras and frames
/// at the estimate. Returns how many corners it rejected.
std::size_t rejectAboveSigma(CameraImuProblem& problem, const CameraImuEstimate& estimate,
                             double sigmas);

}  // namespace plumbline
