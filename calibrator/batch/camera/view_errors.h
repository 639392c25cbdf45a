// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// e = measured - projected [px] of every corner of a view, rejected ones too, by the same function
/// that the Gram kernels charge. A corner that is not in front of the camera gets (1e5, 0).
std::vector<Eigen::Vector2d> viewErrors(const Intrinsics& camera, const Transform& T_CF,
                                        const PackedView& view);

}  // namespace plumbline
