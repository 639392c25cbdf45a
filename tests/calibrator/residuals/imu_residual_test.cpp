// SPDX-License-Identifier: BSD-3-Clause
// The inertial residual: physics of a known motion, Jacobians three ways, whitening.
#include "calibrator/residuals/imu_residual.h"

#include <Eigen/LU>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "tests/calibrator/residuals/imu_test_data.h"

namespace plumbline {
namespace {

constexpr ImuWindow kWindow{100'000'000, 150'000'000, 0.0023};

ImuState someState() {
  ImuState s;
  s.T_FS = Transform(expSO3({0.4, -0.7, 1.1}), {0.3, -0.2, 0.9});
  s.v_F = {0.5, -0.3, 0.2};
  s.gyro_bias = {0.01, -0.02, 0.03};
  s.accel_bias = {0.1, 0.05, -0.2};
  return s;
}

/// A state a little off the one that the IMU predicts, so that no residual vanishes.
ImuState nextState(const ImuState& i) {
  Vector15d d;
  d << 0.02, -0.01, 0.03, 0.05, 0.02, -0.04, 0.1, -0.2, 0.1, 1e-3, 2e-3, -1e-3, 0.01, 0.02, 0.03;
  return boxplus(i, d);
}

Gravity someGravity() { return {Eigen::Vector3d(0.2, -0.9, 0.4).normalized(), 9.8}; }

ImuBias biasOf(const ImuState& s) { return {s.gyro_bias, s.accel_bias}; }

/// Everything r depends on, in one tangent vector: i (15), j (15), gravity (2), t_d.
constexpr int kImuColumns = 33;
using Column = Eigen::Matrix<double, kImuColumns, 1>;

ImuResidual residualAt(const Column& d) {
  const auto samples = test::wavySamples(0, 200, 0.3);
  const ImuState i = boxplus(someState(), Vector15d(d.head<15>()));
  const ImuState j = boxplus(nextState(someState()), Vector15d(d.segment<15>(15)));
  Gravity g = someGravity();
  g.direction = boxplusDirection(g.direction, Eigen::Vector2d(d.segment<2>(30)));
  ImuWindow window = kWindow;
  window.time_offset_s += d(32);
  return imuResidual(*preintegrate(samples, window, biasOf(i)), i, j, g);
}

Eigen::Matrix<double, 9, kImuColumns> analytic() {
  const ImuResidual r = residualAt(Column::Zero());
  Eigen::Matrix<double, 9, kImuColumns> J = Eigen::Matrix<double, 9, kImuColumns>::Zero();
  J.leftCols<15>() = r.J_i;
  J.middleCols<9>(15) = r.J_j;
  J.middleCols<2>(30) = r.J_gravity;
  J.col(32) = r.J_offset;
  return J;
}

TEST(ImuResidual, VanishesForFreeFall) {
  // No force, no rotation: v grows by g T, p by v T + g T^2 / 2.
  std::vector<ImuSample> samples;
  for (int k = 0; k < 21; ++k) samples.push_back({k * 5'000'000, {0, 0, 0}, {0, 0, 0}});
  const Gravity g = someGravity();
  ImuState i = someState();
  i.gyro_bias.setZero();
  i.accel_bias.setZero();
  ImuState j = i;
  const double T = 0.1;
  j.v_F = i.v_F + g.magnitude * T * g.direction;
  j.T_FS.t = i.T_FS.t + i.v_F * T + 0.5 * g.magnitude * T * T * g.direction;
  const auto m = preintegrate(samples, {0, 100'000'000, 0}, {});
  EXPECT_LT(imuResidual(*m, i, j, g).r.norm(), 1e-14);
}

TEST(ImuResidual, AnUprightRestingSensorMeasuresGravityUp) {
  std::vector<ImuSample> samples;
  const Gravity g{-Eigen::Vector3d::UnitZ(), 9.8};
  ImuState i;
  i.T_FS.R = expSO3({0.3, 0.2, -0.1});
  for (int k = 0; k < 21; ++k) {
    samples.push_back(
        {k * 5'000'000, {0, 0, 0}, i.T_FS.R.transpose() * Eigen::Vector3d(0, 0, 9.8)});
  }
  const auto m = preintegrate(samples, {0, 100'000'000, 0}, {});
  EXPECT_LT(imuResidual(*m, i, i, g).r.norm(), 1e-14);
}

TEST(ImuResidual, JacobiansEqualCentralDifferences) {
  Eigen::Matrix<double, 9, kImuColumns> numeric;
  const double h = 1e-5;
  for (int k = 0; k < kImuColumns; ++k) {
    const Column d = h * Column::Unit(k);
    numeric.col(k) = (residualAt(d).r - residualAt(-d).r) / (2 * h);
  }
  EXPECT_LT((analytic() - numeric).cwiseAbs().maxCoeff(), 2e-8);
}

using ImuJet = ceres::Jet<double, kImuColumns>;
using ImuVec3 = oracle::Vec3<ImuJet>;

ImuVec3 imuVariable(const Eigen::Vector3d& value, int at) {
  return {ImuJet(value(0), at), ImuJet(value(1), at + 1), ImuJet(value(2), at + 2)};
}

Eigen::Quaternion<ImuJet> imuRotation(const Eigen::Matrix3d& R, int at) {
  const Eigen::Quaterniond q(R);
  const Eigen::Quaternion<ImuJet> base(ImuJet(q.w()), ImuJet(q.x()), ImuJet(q.y()), ImuJet(q.z()));
  return oracle::expQuaternion<ImuJet>(imuVariable(Eigen::Vector3d::Zero(), at)) * base;
}

TEST(ImuResidual, JacobiansEqualAutomaticDifferentiation) {
  const auto samples = test::wavySamples(0, 200, 0.3);
  const ImuState i = someState();
  const ImuState j = nextState(i);
  const auto q_i = imuRotation(i.T_FS.R, 3);
  const auto q_j = imuRotation(j.T_FS.R, 18);
  const ImuVec3 p_i = imuVariable(i.T_FS.t, 0);
  const ImuVec3 p_j = imuVariable(j.T_FS.t, 15);
  const ImuVec3 v_i = imuVariable(i.v_F, 6);
  const ImuVec3 v_j = imuVariable(j.v_F, 21);
  const auto m =
      test::oracleMotion<ImuJet>(samples, kWindow, imuVariable(i.gyro_bias, 9),
                                 imuVariable(i.accel_bias, 12), ImuJet(kWindow.time_offset_s, 32));
  // The sphere to first order: direction + basis d.
  const Gravity gravity = someGravity();
  const auto basis = tangentBasis(gravity.direction);
  ImuVec3 g;
  for (int k = 0; k < 3; ++k) {
    g(k) = gravity.magnitude * (ImuJet(gravity.direction(k)) + basis(k, 0) * ImuJet(0.0, 30) +
                                basis(k, 1) * ImuJet(0.0, 31));
  }
  const ImuJet T(kWindow.duration_s());
  const ImuVec3 dv = v_j - v_i - g * T;
  const ImuVec3 dp = p_j - p_i - v_i * T - g * (T * T / 2.0);
  const ImuVec3 r_R = oracle::logQuaternion<ImuJet>(m.q.conjugate() * q_i.conjugate() * q_j);
  const ImuVec3 r_v = q_i.conjugate() * dv - m.v;
  const ImuVec3 r_p = q_i.conjugate() * dp - m.p;
  const auto J = analytic();
  const ImuResidual r = residualAt(Column::Zero());
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(r.r(k), r_R(k).a, 1e-13);
    EXPECT_NEAR(r.r(3 + k), r_v(k).a, 1e-13);
    EXPECT_NEAR(r.r(6 + k), r_p(k).a, 1e-13);
    EXPECT_LT((J.row(k).transpose() - r_R(k).v).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((J.row(3 + k).transpose() - r_v(k).v).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((J.row(6 + k).transpose() - r_p(k).v).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(ImuState, BoxplusAndBoxminusAreInverse) {
  const ImuState a = someState();
  const Vector15d d = Vector15d::LinSpaced(-0.4, 0.5);
  EXPECT_LT((boxminus(boxplus(a, d), a) - d).norm(), 1e-14);
}

TEST(GravityDirection, MovesByTheStatedAngleAndStaysAUnitVector) {
  const Eigen::Vector3d g = someGravity().direction;
  const Eigen::Vector3d moved = boxplusDirection(g, {0.3, -0.4});
  EXPECT_NEAR(moved.norm(), 1, 1e-15);
  EXPECT_NEAR(std::acos(moved.dot(g)), 0.5, 1e-14);
  EXPECT_NEAR((tangentBasis(g).transpose() * moved).x(), std::sin(0.5) * 0.6, 1e-14);
}

TEST(ImuWeight, WhitensTheCovarianceAndTheWalks) {
  const auto samples = test::wavySamples(0, 200, 0.3);
  const ImuNoise noise;
  const auto P = preintegrationCovariance(samples, kWindow, {}, noise);
  ASSERT_TRUE(P);
  const ImuWeight w = imuWeight(*P, noise, 0.05);
  EXPECT_LT((w.sqrt_information * *P * w.sqrt_information.transpose() - Matrix9d::Identity())
                .cwiseAbs()
                .maxCoeff(),
            1e-9);
  EXPECT_TRUE(w.sqrt_information.isLowerTriangular());
  EXPECT_NEAR(w.gyro_walk * noise.gyro_random_walk * std::sqrt(0.05), 1, 1e-15);
  EXPECT_NEAR(w.accel_walk * noise.accel_random_walk * std::sqrt(0.05), 1, 1e-15);
  EXPECT_TRUE(biasWalkWeight(noise, 0.05).sqrt_information.isZero());
}

}  // namespace
}  // namespace plumbline
