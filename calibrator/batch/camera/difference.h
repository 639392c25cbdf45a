// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// Parameters of `to` minus those of `from` (the same cameras and models), in the order of the
/// camera stage's covariance: the stacked intrinsics of all cameras, then boxminus(to.T_C0Ci,
/// from.T_C0Ci) of all but the first [m, rad].
Eigen::VectorXd cameraDifference(const std::vector<CameraCalibration>& to,
                                 const std::vector<CameraCalibration>& from);

}  // namespace plumbline
