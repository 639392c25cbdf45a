// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/batch/camera_batch_problem.h"

namespace plumbline {

/// CornerFilter::kSigma at an estimate: gives weight 0 to every corner with |e| above `sigmas`
/// times its camera's standard deviation per axis, taken robustly from the median of |e| over the
/// camera's used corners (median of a Rayleigh distribution: 1.1774 sigma), so that the outliers
/// themselves do not widen it. Returns how many corners it rejected.
std::size_t rejectAboveSigma(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate, double sigmas);

/// CornerFilter::kKalibr at an estimate: every view's own pose is refined with the cameras held,
/// then corners above mean + 2 std of the view's |e| and above 0.2 px get weight 0. Returns their
/// number.
std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate);

}  // namespace plumbline
