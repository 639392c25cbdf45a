// SPDX-License-Identifier: BSD-3-Clause
// OpenCV's projections as an independent oracle of ours.
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calibrator/camera/camera.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

std::vector<cv::Point3d> gridPoints() {
  std::vector<cv::Point3d> all;
  for (double x = -0.8; x < 0.9; x += 0.2) {
    for (double y = -0.6; y < 0.7; y += 0.2) all.emplace_back(1.5 * x, 1.5 * y, 1.5);
  }
  return all;
}

std::vector<cv::Point2d> projectedByOpenCv(const Intrinsics& camera) {
  const Eigen::VectorXd& f = camera.projection;
  const cv::Matx33d K(f[0], 0, f[2], 0, f[1], f[3], 0, 0, 1);
  const Eigen::VectorXd& d = camera.distortion;
  const std::vector<double> D(d.begin(), d.end());
  const cv::Vec3d zero(0, 0, 0);
  std::vector<cv::Point2d> uv;
  if (camera.distortion_model == DistortionModel::kEquidistant) {
    cv::fisheye::projectPoints(gridPoints(), uv, zero, zero, K, D);
  } else {
    cv::projectPoints(gridPoints(), zero, zero, K, D, uv);
  }
  return uv;
}

TEST(Project, EqualsOpenCv) {
  std::vector<Intrinsics> cameras = test::allCameras();
  cameras.push_back(test::rationalCamera());
  for (const Intrinsics& camera : cameras) {
    const std::vector<cv::Point2d> expected = projectedByOpenCv(camera);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const cv::Point3d p = gridPoints()[i];
      const auto uv = project(camera, {p.x, p.y, p.z});
      ASSERT_TRUE(uv.has_value());
      EXPECT_NEAR(uv->x(), expected[i].x, 1e-10);
      EXPECT_NEAR(uv->y(), expected[i].y, 1e-10);
    }
  }
}

}  // namespace
}  // namespace plumbline
