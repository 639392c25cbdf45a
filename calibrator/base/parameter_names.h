// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

struct ParameterName {
  std::string name;
  std::string unit;  ///< "px", "-", "m" or "rad"
};

/// Names of Intrinsics::stacked(), in its order, as Kalibr's documents call them: xi, alpha, beta
/// before fu fv pu pv, then k1 ... p2, k1 ... k4, or w.
std::vector<ParameterName> intrinsicParameters(ProjectionModel projection,
                                               DistortionModel distortion);

/// Names and units of a rig's cameras: all intrinsics ("cam0.fu", by the camera's name or, without
/// one, its place), then the tangents of all T_C0Ci but the first ("T_C0C1.tx" .. "T_C0C1.rz").
std::vector<ParameterName> cameraParameters(const std::vector<CameraCalibration>& cameras);

/// The tangent of a Transform: "NAME.tx" .. "NAME.tz" [m], "NAME.rx" .. "NAME.rz" [rad].
std::vector<ParameterName> transformParameters(const std::string& name);

/// A list with its covariance; without `matrix` the list alone.
ParameterCovariance parameterCovariance(const std::vector<ParameterName>& parameters,
                                        const Eigen::MatrixXd& matrix = {});

}  // namespace plumbline
