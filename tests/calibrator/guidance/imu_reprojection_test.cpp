// SPDX-License-Identifier: BSD-3-Clause
// The expected error of points that the IMU predicts, against drawn errors and motions, and under
// other frames for the same rig.
#include "calibrator/guidance/trajectories/imu_reprojection.h"

#include <Eigen/Cholesky>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/rig.h"

namespace plumbline {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;

struct Rig {
  std::vector<CameraCalibration> cameras;
  Transform T_SC0;
};

Rig euroc() {
  const SimulatedRig rig = simulatedRig("euroc");
  return {rig.calibration.cameras, rig.calibration.imu->T_SC0};
}

/// 0.3 to 1 mm, 0.2 to 0.6 mrad and 50 us, everything correlated.
Matrix7d covariance() {
  Matrix7d L = Matrix7d::Zero();
  for (int r = 0; r < 7; ++r) {
    for (int c = 0; c <= r; ++c) L(r, c) = r == c ? 1 : 0.25 * std::cos(3.0 * r + 5.0 * c);
  }
  Vector7d scale;
  scale << 3e-4, 1e-3, 5e-4, 2e-4, 6e-4, 4e-4, 5e-5;
  const Matrix7d S = scale.asDiagonal() * L;
  return S * S.transpose();
}

double expected(const Rig& rig, const Matrix7d& S, const ImuUse& use = {}) {
  return *ImuReprojection(rig.cameras, use).expectedError(S.inverse(), rig.T_SC0);
}

/// Draws standard normal vectors.
class Normals {
 public:
  template <int N>
  Eigen::Matrix<double, N, 1> next() {
    Eigen::Matrix<double, N, 1> v;
    for (int i = 0; i < N; ++i) v[i] = random_.normal();
    return v;
  }

 private:
  RandomStream random_{7, RandomPurpose::kTrajectory};
};

/// Mean squared shift [px^2] of the grid's points: the rig with errors looks for each where its own
/// T_SC0 has the camera, at the pose that the sensor has at its own time offset.
double drawn(const Rig& rig, const Matrix7d& S, const ImuUse& use, int draws) {
  const Matrix7d L = S.llt().matrixL();
  Normals normals;
  double sum = 0;
  int count = 0;
  for (int i = 0; i < draws; ++i) {
    const Vector7d error = L * normals.next<7>();
    const Eigen::Vector3d v = use.speed_m_s / std::sqrt(3) * normals.next<3>();
    const Eigen::Vector3d w = use.rate_rad_s / std::sqrt(3) * normals.next<3>();
    const Transform later(expSO3(error[6] * w), error[6] * v);  // the sensor, in where it was
    const Transform T_SC0 = boxplus(rig.T_SC0, Vector6d(error.head<6>()));
    for (const CameraCalibration& camera : rig.cameras) {
      const Transform shift = (later * T_SC0 * camera.T_C0Ci).inverse() * rig.T_SC0 * camera.T_C0Ci;
      const Resolution size = camera.intrinsics.resolution;
      // One point a draw and camera, from the grid in turn.
      const int k = i % (use.columns * use.rows);
      const Eigen::Vector2d uv(
          (k % use.columns) * (size.width - 1.0) / (use.columns - 1),
          static_cast<int>(k / use.columns) * (size.height - 1.0) / (use.rows - 1));
      const auto ray = unproject(camera.intrinsics, uv);
      for (const double range_m : use.ranges_m) {
        const auto seen = project(camera.intrinsics, shift * Eigen::Vector3d(range_m * *ray));
        sum += (*seen - uv).squaredNorm();
        ++count;
      }
    }
  }
  return sum / count;
}

TEST(ImuReprojection, IsTheMeanSquaredShiftOfDrawnErrorsAndMotions) {
  const Rig rig = euroc();
  for (const double rate_rad_s : {0.0, 1.0, 6.0}) {
    ImuUse use;
    use.rate_rad_s = use.speed_m_s = rate_rad_s;
    // The offset's part grows from nothing to most of it: 50 us and 6 rad/s beside 0.4 mrad.
    Matrix7d S = covariance();
    S.row(6) *= 10, S.col(6) *= 10;
    const double E = expected(rig, S, use);
    EXPECT_NEAR(drawn(rig, S, use, 63 * 400), E, 0.05 * E) << rate_rad_s;
  }
}

TEST(ImuReprojection, OfARotationAloneIsTheFocalLengthTimesIt) {
  // At the centre of the image and of one pixel, far away: two axes shift it, by f each.
  Rig rig = euroc();
  rig.cameras.resize(1);
  ImuUse use;
  use.columns = use.rows = 1;
  Intrinsics& camera = rig.cameras[0].intrinsics;
  camera.projection[2] = camera.projection[3] = 0;  // (0, 0) is the one pixel of the grid
  camera.distortion.setZero();
  Matrix7d S = 1e-24 * Matrix7d::Identity();
  S.block<3, 3>(3, 3) = 1e-6 * Eigen::Matrix3d::Identity();
  // They turn the camera about its own centre: no lever.
  const double f2 = camera.projection.head<2>().squaredNorm();
  EXPECT_NEAR(expected(rig, S, use), 1e-6 * f2, 1e-3 * 1e-6 * f2);
}

/// The covariance of the same errors in other coordinates: T' = change(T), numerically.
template <class Change>
Matrix7d carriedOver(const Matrix7d& S, const Transform& T, const Change& change) {
  Matrix7d J = Matrix7d::Identity();
  const double h = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Vector6d d = h * Vector6d::Unit(i);
    J.block<6, 1>(0, i) =
        boxminus(change(boxplus(T, d)), change(boxplus(T, Vector6d(-d)))) / (2 * h);
  }
  return J * S * J.transpose();
}

TEST(ImuReprojection, DoesNotDependOnWhichCameraIsTheFirst) {
  const Rig rig = euroc();
  const Transform T_C0C1 = rig.cameras[1].T_C0Ci;
  const auto change = [&](const Transform& T_SC0) { return T_SC0 * T_C0C1; };
  Rig other{{rig.cameras[1], rig.cameras[0]}, change(rig.T_SC0)};
  other.cameras[0].T_C0Ci = Transform();
  other.cameras[1].T_C0Ci = T_C0C1.inverse();
  const double E = expected(rig, covariance());
  EXPECT_NEAR(expected(other, carriedOver(covariance(), rig.T_SC0, change)), E, 1e-6 * E);
}

TEST(ImuReprojection, DoesNotDependOnTheSensorsAxes) {
  const Rig rig = euroc();
  const Transform turned(expSO3(Eigen::Vector3d(0.4, -1.1, 2.0)), Eigen::Vector3d::Zero());
  const auto change = [&](const Transform& T_SC0) { return turned * T_SC0; };
  const Rig other{rig.cameras, change(rig.T_SC0)};
  const double E = expected(rig, covariance());
  EXPECT_NEAR(expected(other, carriedOver(covariance(), rig.T_SC0, change)), E, 1e-6 * E);
}

TEST(ImuReprojection, IsTheSameFromTheCovarianceAndOfSingleErrors) {
  const Rig rig = euroc();
  const ImuReprojection use(rig.cameras);
  const double E = expected(rig, covariance());
  EXPECT_NEAR(use.expectedErrorUnder(covariance(), rig.T_SC0), E, 1e-9 * E);
  // Along the columns of a root of the covariance the squares add up to it.
  const Matrix7d L = covariance().llt().matrixL();
  ImuCalibration truth;
  truth.T_SC0 = rig.T_SC0;
  truth.time_offsets = {TimeOffset()};
  double sum = 0;
  for (int i = 0; i < 7; ++i) {
    ImuCalibration off = truth;
    off.T_SC0 = boxplus(rig.T_SC0, Vector6d(L.col(i).head<6>()));
    off.time_offsets.front().s += L(6, i);
    sum += std::pow(use.differencePx(off, truth), 2);
  }
  EXPECT_NEAR(sum, E, 1e-6 * E);
}

TEST(ImuReprojection, SaysNothingWhereSomethingIsFree) {
  const Rig rig = euroc();
  Matrix7d information = covariance().inverse();
  information.row(6).setZero();
  information.col(6).setZero();
  EXPECT_FALSE(ImuReprojection(rig.cameras).expectedError(information, rig.T_SC0));
}

}  // namespace
}  // namespace plumbline
