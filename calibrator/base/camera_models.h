// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

// What is known of the camera models by name: their words (toString() and ...From() of
// calibration.h), the names and numbers of their parameters, and which can be calibrated. All of it
// stands in one table (camera_models.cpp); the mathematics are in calibrator/camera.

struct ParameterName {
  std::string name;
  std::string unit;  ///< "px", "-", "m" or "rad"
};

/// Names of Intrinsics::stacked(), in its order, as Kalibr's documents call them: xi, alpha, beta
/// before fu fv pu pv, then k1 ... p2, k1 ... k4, or w.
std::vector<ParameterName> intrinsicParameters(ProjectionModel projection,
                                               DistortionModel distortion);

/// Length of Intrinsics::projection and of Intrinsics::distortion.
std::size_t parameterCount(ProjectionModel model);
std::size_t parameterCount(DistortionModel model);

/// "pinhole, omni, eucm, ds": every word that toString() gives, for messages.
std::string projectionModelWords();
std::string distortionModelWords();

/// Whether cameras of this kind can be calibrated; the others project, and are scored and compared.
constexpr bool canBeCalibrated(ProjectionModel projection, DistortionModel distortion) {
  return projection == ProjectionModel::kPinhole &&
         (distortion == DistortionModel::kRadtan || distortion == DistortionModel::kEquidistant);
}
/// "pinhole-radtan or pinhole-equidistant".
std::string calibratedModelWords();

/// "calibrating the camera model omni-radtan is not supported yet; expected ...": the text with
/// which every reader refuses another model.
std::string unsupportedModelText(const std::string& projection, const std::string& distortion);

/// Names and units of a rig's cameras: all intrinsics ("cam0.fu", by the camera's name or, without
/// one, its place), then the tangents of all T_C0Ci but the first ("T_C0C1.tx" .. "T_C0C1.rz").
std::vector<ParameterName> cameraParameters(const std::vector<CameraCalibration>& cameras);

/// The tangent of a Transform: "NAME.tx" .. "NAME.tz" [m], "NAME.rx" .. "NAME.rz" [rad].
std::vector<ParameterName> transformParameters(const std::string& name);

/// A list with its covariance; without `matrix` the list alone.
ParameterCovariance parameterCovariance(const std::vector<ParameterName>& parameters,
                                        const Eigen::MatrixXd& matrix = {});

}  // namespace plumbline
