// SPDX-License-Identifier: BSD-3-Clause
// Keys as ROS' camera_calibration_parsers reads them.
#include <fmt/format.h>

#include "datasets/calibration/export/tools.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::string matrixText(const char* key, const RowMajor& M) {
  const Eigen::Map<const Eigen::VectorXd> values(M.data(), M.size());
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", key, M.rows(), M.cols(),
                     yamlList(values));
}

constexpr PinholeWords kRosWords{"plumb_bob", "equidistant", "rational_polynomial"};

// ROS has the word plumb_bob with five coefficients, the fifth for r^6.
Eigen::VectorXd rosCoefficients(const Intrinsics& k) {
  if (k.distortion_model == DistortionModel::kEquidistant ||
      k.distortion_model == DistortionModel::kRational) {
    return k.distortion;
  }
  Eigen::VectorXd five = Eigen::VectorXd::Zero(5);  // k1 k2 p1 p2 k3
  five.head(4) = fourCoefficients(k);
  return five;
}

std::string cameraText(const CameraCalibration& camera, const char* distortion) {
  const Intrinsics& k = camera.intrinsics;
  RowMajor K = RowMajor::Identity(3, 3);
  K(0, 0) = k.projection[0];
  K(1, 1) = k.projection[1];
  K.col(2).head(2) = k.projection.tail(2);
  RowMajor P = RowMajor::Zero(3, 4);
  // P = [K 0] and R = I: each camera by itself, not as one of a rectified pair.
  P.leftCols(3) = K;
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", k.resolution.width,
                     k.resolution.height, plainName(camera.name)) +
         matrixText("camera_matrix", K) + fmt::format("distortion_model: {}\n", distortion) +
         matrixText("distortion_coefficients", rosCoefficients(k).transpose()) +
         matrixText("rectification_matrix", RowMajor::Identity(3, 3)) +
         matrixText("projection_matrix", P);
}

std::vector<std::string> cameraInfoWarnings(const Calibration& calibration) {
  std::vector<std::string> warnings;
  if (calibration.cameras.size() > 1) {
    warnings.emplace_back(
        "camera_info describes one camera: the transforms between cameras are not in these files. "
        "R is the identity and P = [K 0]: not rectified for stereo.");
  }
  if (calibration.imu) {
    warnings.emplace_back(
        "camera_info describes no IMU: its transform, time offset and noise are not in these "
        "files.");
  }
  return warnings;
}

}  // namespace

ExportedFiles exportCameraInfo(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  ExportedFiles out;
  out.warnings = cameraInfoWarnings(calibration);
  for (const CameraCalibration& camera : calibration.cameras) {
    const std::string name = plainName(camera.name) + ".yaml";
    for (std::size_t i = 0; i < out.files.size(); ++i) {
      if (out.files[i].name != name) continue;
      source.refuse(InputFault::kDuplicate,
                    fmt::format("the files of the cameras {} and {} would both be {}",
                                calibration.cameras[i].name, camera.name, name),
                    "rename one");
    }
    out.files.push_back({name, commentHeader(options, out.warnings) +
                                   cameraText(camera, source.distortionWord(camera, kRosWords))});
  }
  return out;
}

}  // namespace plumbline
