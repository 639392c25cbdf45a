// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// One view of a camera (index into its PackedCorners) and the pose of the target in it.
struct PosedView {
  int view = 0;
  Transform T_CF;
};

/// CornerFilter::kSigma for one camera at an estimate, in both stages: gives weight 0 to every used
/// corner of the views with |e| above `sigmas` times the standard deviation per axis, taken
/// robustly from the median of |e| over the camera's used corners (median of a Rayleigh
/// distribution: sqrt(2 ln 2) = 1.1774 sigma), so that the outliers themselves do not widen it.
/// Corners that cannot be projected count as far off (see viewErrors()). Returns how many it
/// rejected.
std::size_t rejectAboveSigma(PackedCorners& corners, const Intrinsics& camera,
                             const std::vector<PosedView>& views, double sigmas);

/// CornerFilter::kKalibr for one view: positions of its used corners with |e| above mean + 2 std of
/// the view's used corners and above 0.2 px, with the pose refined from `start` on this view alone
/// and the camera held.
std::vector<int> kalibrOutliers(const Intrinsics& camera, const PackedView& view,
                                const Transform& start);

}  // namespace plumbline
