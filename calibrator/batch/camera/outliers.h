// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// CornerFilter::kSigma and kKalibr over all cameras and frames at an estimate, by the rules of
/// corner_outliers.h. Return how many corners they rejected.
std::size_t rejectAboveSigma(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate, double sigmas);
std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate);

}  // namespace plumbline
