// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/trajectory.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const std::vector<MotionKind> kAllKinds{
    MotionKind::kFull,   MotionKind::kPureRotation, MotionKind::kSingleAxisRotation,
    MotionKind::kPlanar, MotionKind::kStatic,       MotionKind::kFrontoParallel};

AnalyticTrajectory makeTrajectory(MotionKind kind, std::uint64_t seed = 1,
                                  const Vector3d& axis = Vector3d::UnitY()) {
  TrajectoryOptions options;
  options.kind = kind;
  options.seed = seed;
  options.axis_S = axis;
  return AnalyticTrajectory(AprilGrid{}, simulatedRig("euroc"), options);
}

// Central differences with step h err by h^2 / 6 times the third derivative (below 1e3 here): with
// h = 1e-4 s about 1e-6, and rounding adds 1e-16 / h.
TEST(Trajectory, DerivativesAreThoseOfThePose) {
  constexpr double kStep = 1e-4;
  constexpr double kTolerance = 2e-6;
  for (const MotionKind kind : kAllKinds) {
    const AnalyticTrajectory trajectory = makeTrajectory(kind);
    for (double t = 0; t < 20; t += 0.37) {
      SCOPED_TRACE(testing::Message() << "kind " << static_cast<int>(kind) << ", t " << t);
      const MotionState a = trajectory.at(t - kStep);
      const MotionState m = trajectory.at(t);
      const MotionState b = trajectory.at(t + kStep);
      const Vector3d velocity = (b.T_FB.t - a.T_FB.t) / (2 * kStep);
      const Vector3d acceleration = (b.v_F - a.v_F) / (2 * kStep);
      const Vector3d omega = logSO3(a.T_FB.R.transpose() * b.T_FB.R) / (2 * kStep);
      const Vector3d alpha = (b.omega_B - a.omega_B) / (2 * kStep);
      ASSERT_LE((velocity - m.v_F).norm(), kTolerance);
      ASSERT_LE((acceleration - m.a_F).norm(), kTolerance);
      ASSERT_LE((omega - m.omega_B).norm(), kTolerance);
      ASSERT_LE((alpha - m.alpha_B).norm(), kTolerance);
      ASSERT_LE((m.T_FB.R.transpose() * m.T_FB.R - Matrix3d::Identity()).norm(), 1e-14);
      ASSERT_NEAR(m.T_FB.R.determinant(), 1, 1e-14);
    }
  }
}

TEST(Trajectory, FullMotionExcitesEveryAxis) {
  const AnalyticTrajectory trajectory = makeTrajectory(MotionKind::kFull);
  Matrix3d rate = Matrix3d::Zero();
  Matrix3d acceleration = Matrix3d::Zero();
  double fastest = 0;
  double hardest = 0;
  int count = 0;
  for (double t = 0; t < 30; t += 0.01, ++count) {
    const MotionState m = trajectory.at(t);
    rate += m.omega_B * m.omega_B.transpose();
    acceleration += m.a_F * m.a_F.transpose();
    fastest = std::max(fastest, m.omega_B.norm());
    hardest = std::max(hardest, m.a_F.norm());
  }
  const auto weakest = [&](const Matrix3d& second_moment) {
    const Matrix3d mean = second_moment / count;
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(mean).eigenvalues().minCoeff());
  };
  EXPECT_GT(weakest(rate), 0.25);         // RMS about the least excited axis [rad/s]
  EXPECT_GT(weakest(acceleration), 0.2);  // RMS along the least excited axis [m/s^2]
  EXPECT_LT(fastest, 4.0);                // what a hand does, and a gyro's range allows
  EXPECT_LT(hardest, 8.0);
}

TEST(Trajectory, SeedsGiveDifferentMotionsOfTheSameKind) {
  const AnalyticTrajectory a = makeTrajectory(MotionKind::kFull, 1);
  const AnalyticTrajectory again = makeTrajectory(MotionKind::kFull, 1);
  const AnalyticTrajectory b = makeTrajectory(MotionKind::kFull, 2);
  EXPECT_EQ(a.at(3.3).T_FB.matrix(), again.at(3.3).T_FB.matrix());
  EXPECT_GT((a.at(3.3).T_FB.t - b.at(3.3).T_FB.t).norm(), 0.01);
}

TEST(Trajectory, PureRotationKeepsTheImuInPlace) {
  const Vector3d axis = Vector3d(1, 2, -1).normalized();
  const AnalyticTrajectory trajectory = makeTrajectory(MotionKind::kPureRotation, 1, axis);
  const Vector3d origin = trajectory.at(0).T_FB.t;
  double largest = 0;
  for (double t = 0; t < 10; t += 0.1) {
    const MotionState m = trajectory.at(t);
    EXPECT_LE((m.T_FB.t - origin).norm(), 1e-14);
    EXPECT_LE(m.omega_B.cross(axis).norm(), 1e-14);
    largest = std::max(largest, m.omega_B.norm());
  }
  EXPECT_GT(largest, 0.3);
}

TEST(Trajectory, WithoutReachTheOnlyCameraTurnsInPlaceAboutAllAxes) {
  SimulatedRig rig = simulatedRig("euroc");
  rig.calibration.cameras.resize(1);
  const AnalyticTrajectory trajectory(AprilGrid{}, rig, {.reach = 0});
  const Transform& T_SC0 = rig.calibration.imu->T_SC0;
  const Vector3d place = (trajectory.at(0).T_FB * T_SC0).t;
  Matrix3d spread = Matrix3d::Zero();
  for (double t = 0; t < 20; t += 0.37) {
    const MotionState m = trajectory.at(t);
    EXPECT_LT(((m.T_FB * T_SC0).t - place).norm(), 1e-12);
    spread += m.omega_B * m.omega_B.transpose();
  }
  EXPECT_GT(spread.eigenvalues().real().minCoeff(), 1);
}

TEST(Trajectory, PlanarMotionStaysInThePlaneAcrossItsAxis) {
  const Vector3d axis = Vector3d::UnitX();
  const AnalyticTrajectory planar = makeTrajectory(MotionKind::kPlanar, 1, axis);
  const AnalyticTrajectory spatial = makeTrajectory(MotionKind::kSingleAxisRotation, 1, axis);
  double off_plane = 0;
  for (double t = 0; t < 10; t += 0.1) {
    const MotionState m = planar.at(t);
    const MotionState n = spatial.at(t);
    EXPECT_NEAR((m.T_FB.R * axis).dot(m.v_F), 0, 1e-13);
    EXPECT_LE(m.omega_B.cross(axis).norm(), 1e-14);
    EXPECT_LE(n.omega_B.cross(axis).norm(), 1e-14);
    off_plane = std::max(off_plane, std::abs((n.T_FB.R * axis).dot(n.v_F)));
  }
  EXPECT_GT(off_plane, 0.1);
}

TEST(Trajectory, StaticMeansStatic) {
  const AnalyticTrajectory trajectory = makeTrajectory(MotionKind::kStatic);
  const MotionState a = trajectory.at(0);
  const MotionState b = trajectory.at(7.7);
  EXPECT_EQ(a.T_FB.matrix(), b.T_FB.matrix());
  EXPECT_EQ(b.v_F.norm() + b.a_F.norm() + b.omega_B.norm() + b.alpha_B.norm(), 0);
}

TEST(Trajectory, FrontoParallelKeepsTheTargetSquareToCameraZero) {
  const AnalyticTrajectory trajectory = makeTrajectory(MotionKind::kFrontoParallel);
  const Transform T_SC0 = simulatedRig("euroc").calibration.imu->T_SC0;
  for (double t = 0; t < 10; t += 0.1) {
    const Matrix3d R_FC0 = (trajectory.at(t).T_FB * T_SC0).R;
    EXPECT_LE((R_FC0 * Vector3d::UnitZ() + Vector3d::UnitZ()).norm(), 1e-12);
  }
}

/// Whatever the model, the lens is about that of EuRoC's cam0.
TEST(Trajectory, TheBoardFillsTheImageOfEveryModel) {
  const AprilGrid board;
  const double size = std::max(board.width(), board.height());
  for (const Intrinsics& lens : test::everyModel()) {
    if (lens.resolution.height == 512) continue;  // TUM-VI's is another lens
    SCOPED_TRACE(toString(lens.projection_model) + "-" + toString(lens.distortion_model));
    const double distance = fillingDistance(board, lens);
    // Near the axis, where the scale is that of the middle, a hundredth of the board.
    const auto left = project(lens, {-0.005 * size, 0, distance});
    const auto right = project(lens, {0.005 * size, 0, distance});
    ASSERT_TRUE(left && right);
    EXPECT_NEAR(100 * (right->x() - left->x()), lens.resolution.height, 0.5);
    EXPECT_NEAR(distance, fillingDistance(board, test::radtanCamera()), 0.1 * distance);
  }
}

TEST(Trajectory, HalfAngleIsThatOfTheImagesSide) {
  for (Intrinsics lens : test::everyModel()) {
    SCOPED_TRACE(toString(lens.projection_model) + "-" + toString(lens.distortion_model));
    const double u = halfAngle(lens, 0), v = halfAngle(lens, 1);
    if (lens.distortion_model != DistortionModel::kFov) lens.distortion.setZero();
    const Eigen::Vector2d centre = lens.projection.tail<2>();
    const auto right = project(lens, {std::sin(u), 0, std::cos(u)});
    const auto below = project(lens, {0, std::sin(v), std::cos(v)});
    ASSERT_TRUE(right && below);
    EXPECT_NEAR(right->x() - centre.x(), 0.5 * lens.resolution.width, 1e-6);
    EXPECT_NEAR(below->y() - centre.y(), 0.5 * lens.resolution.height, 1e-6);
  }
}

TEST(Trajectory, HalfAngleEndsWhereTheLensDoes) {
  // A unified sphere of xi = 2 images a disc of radius fu / sqrt(xi^2 - 1) = 115 px.
  const Intrinsics lens =
      test::cameraOf(ProjectionModel::kOmni, DistortionModel::kNone, {2, 200, 200, 367, 248}, {});
  EXPECT_GT(halfAngle(lens, 0), 1.5);
  EXPECT_LE(halfAngle(lens, 0), std::acos(-0.5));
}

}  // namespace
}  // namespace plumbline
