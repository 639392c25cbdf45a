// SPDX-License-Identifier: BSD-3-Clause
#include "tests/datasets/calibration/export/exported_rigs.h"

#include <gtest/gtest.h>

#include "calibrator/simulate/rig.h"

namespace plumbline {

ExportOptions exportOptions() { return {"/somewhere/rig.json", "9.9.9", true, 20.0}; }

Calibration rig(const std::string& name) { return simulatedRig(name).calibration; }

Calibration singleCamera(ProjectionModel projection, DistortionModel distortion,
                         const Eigen::VectorXd& projection_values,
                         const Eigen::VectorXd& distortion_values) {
  Calibration calibration = rig("euroc");
  calibration.cameras.resize(1);
  Intrinsics& k = calibration.cameras.front().intrinsics;
  k.projection_model = projection;
  k.distortion_model = distortion;
  k.projection = projection_values;
  k.distortion = distortion_values;
  return calibration;
}

Transform placeOf(const Calibration& calibration, std::size_t camera) {
  return calibration.imu->T_SC0 * calibration.cameras[camera].T_C0Ci;
}

std::string fileText(const ExportedFiles& files, const std::string& name) {
  for (const ExportFile& file : files.files) {
    if (file.name == name) return file.text;
  }
  ADD_FAILURE() << "no file " << name;
  return {};
}

double difference(const Eigen::Matrix4d& a, const Transform& b) {
  return (a - b.matrix()).cwiseAbs().maxCoeff();
}

std::vector<Eigen::Vector3d> pointsInView() {
  std::vector<Eigen::Vector3d> points;
  for (double x = -0.6; x < 0.7; x += 0.3) {
    for (double y = -0.4; y < 0.5; y += 0.2) points.emplace_back(1.7 * x, 1.7 * y, 1.7);
  }
  return points;
}

}  // namespace plumbline
