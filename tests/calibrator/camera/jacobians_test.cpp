// SPDX-License-Identifier: BSD-3-Clause
// The Jacobians of every model: a hand value, automatic differentiation, central differences.
#include <cmath>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "calibrator/camera/camera.h"
#include "calibrator/camera/camera_dispatch.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

using Jacobian = Eigen::Matrix<double, 2, 11>;  // point (3), intrinsics (8)
using Jet = ceres::Jet<double, 11>;

// Points from the axis to the edge of the view, none in special position.
std::vector<Eigen::Vector3d> points() {
  std::vector<Eigen::Vector3d> all = {{0, 0, 1.3}, {1e-9, -2e-9, 1}, {1e-5, 3e-5, 0.7}};
  for (double x : {0.01, 0.2, 0.6, 0.9}) {
    for (double angle : {0.3, 2.0, 4.4}) {
      all.emplace_back(2.1 * x * std::cos(angle), 2.1 * x * std::sin(angle), 2.1);
    }
  }
  return all;
}

Jacobian analytic(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  const Projection projection = projectWithJacobians(camera, p_C).value();
  Jacobian J;
  J << projection.J_point, projection.J_intrinsics;
  return J;
}

Jacobian automatic(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  const Eigen::VectorXd k = camera.stacked();
  Jet point[3], parameter[8];
  for (int i = 0; i < 3; ++i) point[i] = Jet(p_C[i], i);
  for (int i = 0; i < 8; ++i) parameter[i] = Jet(k[i], 3 + i);
  Jacobian J;
  std::visit(
      [&]<class Model>(Model) {
        const auto m = Model::image(parameter + 4, point[0], point[1], point[2]);
        J.row(0) = (parameter[0] * m.x + parameter[2]).v;
        J.row(1) = (parameter[1] * m.y + parameter[3]).v;
      },
      cameraModelOf(camera));
  return J;
}

Jacobian centralDifferences(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  Jacobian J;
  for (int i = 0; i < 11; ++i) {
    const auto at = [&](double step) {
      Eigen::Vector3d p = p_C;
      Eigen::VectorXd k = camera.stacked();
      (i < 3 ? p[i] : k[i - 3]) += step;
      Intrinsics moved = camera;
      moved.setStacked(k);
      return project(moved, p).value();
    };
    // Error of order step^2 from the third derivative and 1e-16 / step from rounding.
    const double step = 1e-5;
    J.col(i) = (at(step) - at(-step)) / (2 * step);
  }
  return J;
}

TEST(CameraJacobians, ByHandForRadtan) {
  // x = 0.5, y = 0, k1 = 0.2 alone: x' = x + k1 x^3, so dx'/dx = 1 + 3 k1 x^2 = 1.15 and
  // dy'/dy = 1 + k1 x^2 = 1.05; Z = 2, f = (100, 200).
  Intrinsics camera;
  camera.projection = Eigen::Vector4d(100, 200, 10, 20);
  camera.distortion = Eigen::Vector4d(0.2, 0, 0, 0);
  const Projection projection = projectWithJacobians(camera, {1, 0, 2}).value();
  Eigen::Matrix<double, 2, 3> J_point;
  J_point << 57.5, 0, -28.75, 0, 105, 0;
  EXPECT_TRUE(projection.J_point.isApprox(J_point, 1e-14)) << projection.J_point;
  Eigen::Matrix<double, 2, 8> J_intrinsics;
  J_intrinsics << 0.525, 0, 1, 0, 12.5, 3.125, 0, 75,  //
      0, 0, 0, 1, 0, 0, 50, 0;
  EXPECT_TRUE(projection.J_intrinsics.isApprox(J_intrinsics, 1e-14)) << projection.J_intrinsics;
}

TEST(CameraJacobians, ByHandForEquidistant) {
  // At 45 degrees along x without coefficients: theta = pi/4, dtheta/dx = 1/2, y' = theta y / x.
  Intrinsics camera;
  camera.distortion_model = DistortionModel::kEquidistant;
  camera.projection = Eigen::Vector4d(100, 200, 10, 20);
  camera.distortion = Eigen::Vector4d::Zero();
  const double theta = std::atan(1.0);
  const Projection projection = projectWithJacobians(camera, {2, 0, 2}).value();
  Eigen::Matrix<double, 2, 3> J_point;
  J_point << 25, 0, -25, 0, 100 * theta, 0;
  EXPECT_TRUE(projection.J_point.isApprox(J_point, 1e-14)) << projection.J_point;
  EXPECT_NEAR(projection.J_intrinsics(0, 4), 100 * std::pow(theta, 3), 1e-12);
  EXPECT_NEAR(projection.J_intrinsics(0, 7), 100 * std::pow(theta, 9), 1e-12);
}

TEST(CameraJacobians, EqualAutomaticDifferentiation) {
  for (const Intrinsics& camera : testing::allCameras()) {
    for (const Eigen::Vector3d& p_C : points()) {
      const Jacobian J = analytic(camera, p_C);
      const Jacobian expected = automatic(camera, p_C);
      EXPECT_LT((J - expected).norm(), 1e-10 * expected.norm())
          << toString(camera.distortion_model) << " at " << p_C.transpose() << "\n"
          << J << "\n"
          << expected;
    }
  }
}

TEST(CameraJacobians, EqualCentralDifferences) {
  for (const Intrinsics& camera : testing::allCameras()) {
    for (const Eigen::Vector3d& p_C : points()) {
      const Jacobian J = analytic(camera, p_C);
      const Jacobian expected = centralDifferences(camera, p_C);
      EXPECT_LT((J - expected).norm(), 1e-8 * expected.norm())
          << toString(camera.distortion_model) << " at " << p_C.transpose() << "\n"
          << J << "\n"
          << expected;
    }
  }
}

}  // namespace
}  // namespace plumbline
