// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline::test {

/// A camera like EuRoC's cam0.
inline Intrinsics radtanCamera() {
  Intrinsics camera;
  camera.distortion_model = DistortionModel::kRadtan;
  camera.resolution = {752, 480};
  camera.projection = Eigen::Vector4d(458.654, 457.296, 367.215, 248.375);
  camera.distortion = Eigen::Vector4d(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05);
  return camera;
}

/// A camera like TUM-VI's cam0.
inline Intrinsics equidistantCamera() {
  Intrinsics camera;
  camera.distortion_model = DistortionModel::kEquidistant;
  camera.resolution = {512, 512};
  camera.projection = Eigen::Vector4d(190.978, 190.973, 254.932, 256.897);
  camera.distortion = Eigen::Vector4d(0.0034823894, 0.0007150348, -0.0020532361, 0.00020293673);
  return camera;
}

/// A camera of any models, of the size of EuRoC's.
inline Intrinsics cameraOf(ProjectionModel projection, DistortionModel distortion,
                           std::initializer_list<double> values,
                           std::initializer_list<double> coefficients) {
  Intrinsics camera;
  camera.projection_model = projection;
  camera.distortion_model = distortion;
  camera.resolution = {752, 480};
  camera.projection =
      Eigen::Map<const Eigen::VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
  camera.distortion = Eigen::Map<const Eigen::VectorXd>(
      coefficients.begin(), static_cast<Eigen::Index>(coefficients.size()));
  return camera;
}

/// EuRoC's cam0 in OpenCV's rational model.
inline Intrinsics rationalCamera() {
  return cameraOf(ProjectionModel::kPinhole, DistortionModel::kRational, {461, 460, 365, 248},
                  {1.525, 0.1242, 2e-4, -1e-4, -0.01198, 1.866, 0.5149, -0.02848});
}

/// Those of the models that the vectorised kernel has.
inline std::vector<Intrinsics> allCameras() { return {radtanCamera(), equidistantCamera()}; }

/// EuRoC's cam0 as a double sphere and as EUCM, as another solver found them.
inline Intrinsics doubleSphereCamera() {
  return cameraOf(ProjectionModel::kDs, DistortionModel::kNone,
                  {-0.2385, 0.5679, 351.037, 350.007, 365.888, 249.346}, {});
}
inline Intrinsics eucmCamera() {
  return cameraOf(ProjectionModel::kEucm, DistortionModel::kNone,
                  {0.5917, 1.1241, 460.979, 459.627, 365.887, 249.346}, {});
}

/// One camera of each model: those that are calibrated, and those that are scored only.
inline std::vector<Intrinsics> everyModel() {
  using P = ProjectionModel;
  using D = DistortionModel;
  return {
      radtanCamera(),
      equidistantCamera(),
      rationalCamera(),
      cameraOf(P::kPinhole, D::kFov, {459, 458, 367, 248}, {0.9911}),
      cameraOf(P::kPinhole, D::kNone, {459, 458, 367, 248}, {}),
      cameraOf(P::kOmni, D::kNone, {1.1, 960, 958, 367, 248}, {}),
      cameraOf(P::kOmni, D::kRadtan, {0.9, 870, 868, 367, 248}, {-0.2474, -0.0309, -7e-4, 1e-3}),
      cameraOf(P::kOmni, D::kEquidistant, {0.7, 780, 778, 367, 248}, {-0.05, 0.02, -0.004, 0.001}),
      cameraOf(P::kOmni, D::kFov, {0.5, 690, 688, 367, 248}, {0.4}),
      doubleSphereCamera(),
      eucmCamera()};
}

}  // namespace plumbline::test
