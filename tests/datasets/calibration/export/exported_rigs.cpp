// SPDX-License-Identifier: BSD-3-Clause
#include "tests/datasets/calibration/export/exported_rigs.h"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/rig.h"

namespace plumbline {
namespace {

Eigen::Vector2d opencvFisheyePixel(const Eigen::Vector3d& p_C, const std::vector<double>& f,
                                   const std::vector<double>& d) {
  const cv::Matx33d K(f.at(0), 0, f.at(2), 0, f.at(1), f.at(3), 0, 0, 1);
  std::vector<cv::Point2d> uv;
  cv::fisheye::projectPoints(std::vector<cv::Point3d>{{p_C.x(), p_C.y(), p_C.z()}}, uv,
                             cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K,
                             cv::Vec4d(d.at(0), d.at(1), d.at(2), d.at(3)));
  return {uv[0].x, uv[0].y};
}

}  // namespace

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

Eigen::Vector2d opencvPixel(const Eigen::Vector3d& p_C, const std::vector<double>& f,
                            const std::vector<double>& d) {
  const cv::Matx33d K(f.at(0), 0, f.at(2), 0, f.at(1), f.at(3), 0, 0, 1);
  std::vector<cv::Point2d> uv;
  cv::projectPoints(std::vector<cv::Point3d>{{p_C.x(), p_C.y(), p_C.z()}}, cv::Vec3d(0, 0, 0),
                    cv::Vec3d(0, 0, 0), K, d, uv);
  return {uv[0].x, uv[0].y};
}

void expectPixels(const Calibration& truth, std::size_t camera, const Eigen::Matrix4d& T_SCi,
                  const std::vector<double>& f, const std::vector<double>& d) {
  const Intrinsics& intrinsics = truth.cameras[camera].intrinsics;
  const bool fisheye = intrinsics.distortion_model == DistortionModel::kEquidistant;
  for (const Eigen::Vector3d& p_C : pointsInView()) {
    const Eigen::Vector3d p_S = placeOf(truth, camera) * p_C;
    const Eigen::Vector3d p = (T_SCi.inverse() * p_S.homogeneous()).head<3>();
    const auto expected = project(intrinsics, p_C);
    ASSERT_TRUE(expected.has_value());
    const Eigen::Vector2d uv = fisheye ? opencvFisheyePixel(p, f, d) : opencvPixel(p, f, d);
    EXPECT_LT((uv - *expected).norm(), 1e-9);
  }
}

std::vector<Eigen::Vector3d> pointsInView() {
  std::vector<Eigen::Vector3d> points;
  for (double x = -0.6; x < 0.7; x += 0.3) {
    for (double y = -0.4; y < 0.5; y += 0.2) points.emplace_back(1.7 * x, 1.7 * y, 1.7);
  }
  return points;
}

}  // namespace plumbline
