// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

constexpr double kPi = std::numbers::pi;

// Rotation vectors around every switch between series and closed form, up to just below pi.
std::vector<Eigen::Vector3d> rotationVectors() {
  const std::vector<Eigen::Vector3d> axes = {{1, 0, 0},
                                             Eigen::Vector3d(1, -2, 3).normalized(),
                                             Eigen::Vector3d(-1, 0.1, 0.5).normalized()};
  std::vector<Eigen::Vector3d> all = {Eigen::Vector3d::Zero()};
  for (double angle : {1e-12, 9e-5, 1.1e-4, 0.0999, 0.1001, 1.0, 2.5, kPi - 1e-3, kPi - 1e-8}) {
    for (const Eigen::Vector3d& axis : axes) all.push_back(angle * axis);
  }
  return all;
}

TEST(Lie, SkewIsTheCrossProduct) {
  const Eigen::Vector3d w(1, 2, 3);
  const Eigen::Vector3d p(-4, 5, 0.5);
  EXPECT_EQ(skew(w) * p, w.cross(p));
}

TEST(Lie, ExpByHand) {
  const Eigen::Matrix3d quarter_turn = expSO3({0, 0, kPi / 2});
  Eigen::Matrix3d expected;
  expected << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_TRUE(quarter_turn.isApprox(expected, 1e-15));
}

TEST(Lie, ExpEqualsEigensAngleAxis) {
  for (const Eigen::Vector3d& w : rotationVectors()) {
    if (w.norm() == 0) continue;
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
    EXPECT_LT((expSO3(w) - expected).norm(), 1e-14) << w.transpose();
  }
}

TEST(Lie, LogInvertsExp) {
  for (const Eigen::Vector3d& w : rotationVectors()) {
    EXPECT_LT((logSO3(expSO3(w)) - w).norm(), 1e-14 * (1 + w.norm())) << w.transpose();
  }
}

TEST(Lie, LogOfHalfATurnHasLengthPi) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0.6, 0.8)}) {
    const Eigen::Vector3d w = logSO3(expSO3(kPi * axis));
    EXPECT_NEAR(w.norm(), kPi, 1e-14);
    EXPECT_NEAR(std::abs(w.normalized().dot(axis)), 1, 1e-14);
  }
}

// d Log(Exp(w + d) Exp(w)^T) / dd by central differences: error of order step^2 = 1e-10.
Eigen::Matrix3d leftJacobianByDifferences(const Eigen::Vector3d& w) {
  const double step = 1e-5;
  Eigen::Matrix3d J;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(i);
    const Eigen::Matrix3d back = expSO3(w).transpose();
    J.col(i) = (logSO3(expSO3(w + d) * back) - logSO3(expSO3(w - d) * back)) / (2 * step);
  }
  return J;
}

TEST(Lie, LeftJacobianEqualsDifferences) {
  for (const Eigen::Vector3d& w : rotationVectors()) {
    EXPECT_LT((leftJacobianSO3(w) - leftJacobianByDifferences(w)).norm(), 1e-9) << w.transpose();
  }
}

TEST(Lie, RightJacobianIsTheLeftOneTurnedBack) {
  for (const Eigen::Vector3d& w : rotationVectors()) {
    // Exp(w) Exp(Jr d) = Exp(Jl d) Exp(w), so Jl = R Jr.
    EXPECT_LT((leftJacobianSO3(w) - expSO3(w) * rightJacobianSO3(w)).norm(), 2e-13)
        << w.transpose();
  }
}

TEST(Lie, InverseJacobiansInvert) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  for (const Eigen::Vector3d& w : rotationVectors()) {
    EXPECT_LT((inverseLeftJacobianSO3(w) * leftJacobianSO3(w) - I).norm(), 1e-12) << w.transpose();
    EXPECT_LT((inverseRightJacobianSO3(w) * rightJacobianSO3(w) - I).norm(), 1e-12)
        << w.transpose();
  }
}

TEST(Lie, ShortestTurnLevelsByTheLeastAngle) {
  const Eigen::Vector3d from(0.3, -2, 9);
  const Eigen::Vector3d across = from.unitOrthogonal();
  for (double angle : {0.0, 1e-12, 1e-3, 1.0, 3.0, kPi - 1e-3, kPi - 1e-7}) {
    const Eigen::Vector3d to =
        0.1 * (std::cos(angle) * from + std::sin(angle) * from.norm() * across);
    const Eigen::Matrix3d R = shortestTurn(from, to);
    EXPECT_TRUE((R * from.normalized()).isApprox(to.normalized(), 1e-8)) << angle;
    EXPECT_NEAR(logSO3(R).norm(), angle, 1e-8);
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-14));
  }
}

TEST(Lie, ShortestTurnOfOppositeDirections) {
  const Eigen::Vector3d from(0.3, -2, 9);
  for (double off : {0.0, 1e-12, 1e-9}) {
    const Eigen::Vector3d to = -from + off * from.unitOrthogonal();
    const Eigen::Matrix3d R = shortestTurn(from, to);
    EXPECT_TRUE((R * from).isApprox(to, 1e-7)) << off;
    EXPECT_NEAR(R.determinant(), 1, 1e-14);
  }
}

TEST(Lie, NearestRotationUndoesStretchAndReflection) {
  const Eigen::Matrix3d R = expSO3({0.3, -0.7, 1.1});
  EXPECT_TRUE(nearestRotation(R).isApprox(R, 1e-14));
  EXPECT_TRUE(nearestRotation(1.7 * R).isApprox(R, 1e-14));
  const Eigen::Matrix3d of_reflection = nearestRotation(-R);
  EXPECT_NEAR(of_reflection.determinant(), 1, 1e-14);
  EXPECT_TRUE((of_reflection * of_reflection.transpose()).isIdentity(1e-14));
}

}  // namespace
}  // namespace plumbline
