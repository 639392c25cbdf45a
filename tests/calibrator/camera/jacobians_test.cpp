// SPDX-License-Identifier: BSD-3-Clause
// The Jacobians of every model: a hand value, automatic differentiation, central differences.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "calibrator/camera/camera.h"
#include "calibrator/camera/camera_dispatch.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

// Columns: point (3), intrinsics in the order of stacked() (4 to 9).
using Jacobian = Eigen::Matrix<double, 2, Eigen::Dynamic>;
constexpr int kMost = 15;
using Jet = ceres::Jet<double, kMost>;

int columnsOf(const Intrinsics& camera) { return 3 + static_cast<int>(camera.stacked().size()); }

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
  Jacobian J(2, columnsOf(camera));
  J << projection.J_point, projection.J_intrinsics;
  return J;
}

Jacobian automatic(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  const Eigen::VectorXd values = camera.stacked();
  Jet point[3], parameter[kMost - 3], k[CameraValues::kMostShape];
  for (int i = 0; i < 3; ++i) point[i] = Jet(p_C[i], i);
  for (int i = 0; i < values.size(); ++i) parameter[i] = Jet(values[i], 3 + i);
  Jacobian J(2, columnsOf(camera));
  std::visit(
      [&]<class Model>(Model) {
        for (int i = 0; i < Model::kShape; ++i) k[i] = parameter[shapeColumn<Model>(i)];
        const Jet* lens = parameter + Model::kLeading;
        const auto m = Model::image(k, point[0], point[1], point[2]);
        J.row(0) = (lens[0] * m.x + lens[2]).v.head(J.cols());
        J.row(1) = (lens[1] * m.y + lens[3]).v.head(J.cols());
      },
      cameraModelOf(camera));
  return J;
}

Jacobian centralDifferences(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  Jacobian J(2, columnsOf(camera));
  for (int i = 0; i < J.cols(); ++i) {
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

std::string nameOf(const Intrinsics& camera) {
  return toString(camera.projection_model) + "-" + toString(camera.distortion_model);
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

TEST(CameraJacobians, ByHandForOmni) {
  // p = (3, 0, 4), |p| = 5, xi = 0.4: D = 6, x = 1/2; dD/dX = 0.24, dD/dZ = 1.32, dD/dxi = 5, so
  // dx/dX = (1 - 0.12) / 6, dx/dZ = -0.66 / 6, dx/dxi = -2.5 / 6, dy/dY = 1 / 6.
  const Intrinsics camera =
      test::cameraOf(ProjectionModel::kOmni, DistortionModel::kNone, {0.4, 600, 300, 10, 20}, {});
  const Projection projection = projectWithJacobians(camera, {3, 0, 4}).value();
  EXPECT_TRUE(projection.uv.isApprox(Eigen::Vector2d(310, 20), 1e-14));
  Eigen::Matrix<double, 2, 3> J_point;
  J_point << 88, 0, -66, 0, 50, 0;
  EXPECT_TRUE(projection.J_point.isApprox(J_point, 1e-14)) << projection.J_point;
  Eigen::Matrix<double, 2, 5> J_intrinsics;
  J_intrinsics << -250, 0.5, 0, 1, 0, 0, 0, 0, 0, 1;
  EXPECT_TRUE(projection.J_intrinsics.isApprox(J_intrinsics, 1e-14)) << projection.J_intrinsics;
}

TEST(CameraJacobians, ByHandForEucm) {
  // p = (3, 0, 4), beta = 1, alpha = 1/2: d = 5, D = 4.5, x = 2/3; dD/dX = 0.3, dD/dZ = 0.9,
  // dD/dalpha = 1, dD/dbeta = 0.5 * 9 / 10 = 0.45.
  const Intrinsics camera = test::cameraOf(ProjectionModel::kEucm, DistortionModel::kNone,
                                           {0.5, 1, 450, 900, 10, 20}, {});
  const Projection projection = projectWithJacobians(camera, {3, 0, 4}).value();
  EXPECT_TRUE(projection.uv.isApprox(Eigen::Vector2d(310, 20), 1e-14));
  Eigen::Matrix<double, 2, 3> J_point;
  J_point << 80, 0, -60, 0, 200, 0;
  EXPECT_TRUE(projection.J_point.isApprox(J_point, 1e-14)) << projection.J_point;
  Eigen::Matrix<double, 2, 6> J_intrinsics;
  J_intrinsics << -200.0 / 3, -30, 2.0 / 3, 0, 1, 0, 0, 0, 0, 0, 0, 1;
  EXPECT_TRUE(projection.J_intrinsics.isApprox(J_intrinsics, 1e-14)) << projection.J_intrinsics;
}

TEST(CameraJacobians, ByHandForDoubleSphere) {
  // p = (12, 0, 4) / 4 = (3, 0, 4) with xi = -0.8: d1 = 5, z = 0, d2 = 3; alpha = 1/2: D = 1.5.
  // dz/dX = -0.48, dz/dZ = 0.36, dz/dxi = 5; dD/dz = 1/2 (d2 does not change with z at z = 0), so
  // dD/dX = 0.5 - 0.24 = 0.26, dD/dZ = 0.18, dD/dxi = 2.5, dD/dalpha = 3; x = 2.
  const Intrinsics camera = test::cameraOf(ProjectionModel::kDs, DistortionModel::kNone,
                                           {-0.8, 0.5, 150, 300, 10, 20}, {});
  const Projection projection = projectWithJacobians(camera, {3, 0, 4}).value();
  EXPECT_TRUE(projection.uv.isApprox(Eigen::Vector2d(310, 20), 1e-14));
  Eigen::Matrix<double, 2, 3> J_point;
  J_point << 48, 0, -36, 0, 200, 0;
  EXPECT_TRUE(projection.J_point.isApprox(J_point, 1e-14)) << projection.J_point;
  Eigen::Matrix<double, 2, 6> J_intrinsics;
  J_intrinsics << -500, -600, 2, 0, 1, 0, 0, 0, 0, 0, 0, 1;
  EXPECT_TRUE(projection.J_intrinsics.isApprox(J_intrinsics, 1e-14)) << projection.J_intrinsics;
}

TEST(CameraJacobians, ByHandForFov) {
  // w = pi/2: 2 tan(w/2) = 2; at r = 1/2 along x the angle is pi/4, so r' = 1/2 and is not moved;
  // dr'/dr = 2 / (w (1 + 1)) = 2 / pi; dr'/dw = -r'/w + r d(2 tan(w/2))/dw / (2 w) with
  // d(2 tan(w/2))/dw = 2: -1/pi + 1/pi = 0.
  const double w = std::numbers::pi / 2;
  const Intrinsics camera =
      test::cameraOf(ProjectionModel::kPinhole, DistortionModel::kFov, {100, 200, 10, 20}, {w});
  const Projection projection = projectWithJacobians(camera, {1, 0, 2}).value();
  EXPECT_TRUE(projection.uv.isApprox(Eigen::Vector2d(60, 20), 1e-14));
  EXPECT_NEAR(projection.J_point(0, 0), 100 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(projection.J_point(1, 1), 100, 1e-12);
  EXPECT_NEAR(projection.J_intrinsics(0, 4), 0, 1e-12);
}

TEST(CameraJacobians, OfFovHoldWhereItsSeriesTakeOver) {
  for (const double w : {0.0, 1e-9, 1e-3, 0.0099, 0.0101, 3.0}) {
    const Intrinsics camera =
        test::cameraOf(ProjectionModel::kPinhole, DistortionModel::kFov, {100, 200, 10, 20}, {w});
    for (const double x : {0.0, 1e-7, 1e-3, 0.2, 1.0, 30.0}) {
      const Eigen::Vector3d p_C(x, -0.5 * x, 1);
      const Jacobian J = analytic(camera, p_C);
      const Jacobian expected = centralDifferences(camera, p_C);
      // The step is up to a thousandth of w: its square times the third derivative.
      EXPECT_LT((J - expected).norm(), 3e-6 * expected.norm()) << w << " at " << x;
    }
  }
}

TEST(CameraJacobians, EqualAutomaticDifferentiation) {
  for (const Intrinsics& camera : test::everyModel()) {
    for (const Eigen::Vector3d& p_C : points()) {
      const Jacobian J = analytic(camera, p_C);
      const Jacobian expected = automatic(camera, p_C);
      EXPECT_LT((J - expected).norm(), 1e-10 * expected.norm())
          << nameOf(camera) << " at " << p_C.transpose() << "\n"
          << J << "\n"
          << expected;
    }
  }
}

TEST(CameraJacobians, EqualCentralDifferences) {
  for (const Intrinsics& camera : test::everyModel()) {
    for (const Eigen::Vector3d& p_C : points()) {
      const Jacobian J = analytic(camera, p_C);
      const Jacobian expected = centralDifferences(camera, p_C);
      EXPECT_LT((J - expected).norm(), 1e-8 * expected.norm())
          << nameOf(camera) << " at " << p_C.transpose() << "\n"
          << J << "\n"
          << expected;
    }
  }
}

}  // namespace
}  // namespace plumbline
