// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/camera_models.h"

namespace plumbline {

/// Names and units of a rig's cameras: all intrinsics ("cam0.fu", by the camera's name or, without
/// one, its place), then the tangents of all T_C0Ci but the first ("T_C0C1.tx" .. "T_C0C1.rz").
std::vector<ParameterName> cameraParameters(const std::vector<CameraCalibration>& cameras);

/// The tangent of a Transform: "NAME.tx" .. "NAME.tz" [m], "NAME.rx" .. "NAME.rz" [rad].
std::vector<ParameterName> transformParameters(const std::string& name);

/// A list with its covariance; without `matrix` the list alone.
ParameterCovariance parameterCovariance(const std::vector<ParameterName>& parameters,
                                        const Eigen::MatrixXd& matrix = {});

}  // namespace plumbline
