// SPDX-License-Identifier: BSD-3-Clause
// The hand-eye residual: a hand value, automatic differentiation, central differences.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/hand_eye.h"
#include "tests/calibrator/residuals/imu_oracle.h"

namespace plumbline {
namespace {

constexpr int kHandEyeColumns = 13;
using HandEyeJacobian = Eigen::Matrix<double, 6, kHandEyeColumns>;
using HandEyeJet = ceres::Jet<double, kHandEyeColumns>;
using HandEyeVec3 = oracle::Vec3<HandEyeJet>;

HandEyePair examplePair() {
  HandEyePair pair;
  pair.T_WS = {expSO3({0.3, -1.1, 0.6}), {1.5, -0.4, 2}};
  pair.T_VM = {expSO3({-0.9, 0.2, 1.7}), {-3, 1, 0.5}};
  pair.v_V = {0.7, -1.2, 0.3};
  pair.omega_V = {-0.4, 0.9, 1.3};
  return pair;
}

// Its residual's angle is about 0.7 rad.
HandEyeState exampleState(const HandEyePair& pair) {
  HandEyeState state;
  state.T_SM = {expSO3({0.5, 0.8, -0.3}), {0.12, -0.05, 0.2}};
  state.T_VW = pair.T_VM * (pair.T_WS * state.T_SM).inverse();
  Vector6d d;
  d << 0.1, -0.3, 0.2, 0.5, -0.4, 0.3;
  state.T_VW = boxplus(state.T_VW, d);
  state.offset_s = 0.02;
  return state;
}

HandEyeJacobian analytic(const HandEyePair& pair, const HandEyeState& state) {
  const HandEyeResidual e = handEyeResidual(pair, state);
  HandEyeJacobian J;
  J << e.J_SM, e.J_VW, e.J_offset;
  return J;
}

TEST(HandEyeResidual, OfAQuarterTurnByHand) {
  HandEyePair pair;
  pair.T_WS.t = {1, 0, 0};
  pair.v_V = {0, 0, 2};
  HandEyeState state;
  state.T_SM.t = {0, 1, 0};
  state.T_VW.R = expSO3({0, 0, 1.5707963267948966});
  state.offset_s = 0.5;
  // S at (1,0,0), M at (1,1,0) in W, at (-1,1,0) in V; the truth at the origin has moved up by 1.
  Vector6d expected;
  expected << -1, 1, -1, 0, 0, 1.5707963267948966;
  EXPECT_LT((handEyeResidual(pair, state).r - expected).norm(), 1e-14);
}

TEST(HandEyeResidual, IsZeroForTheTruth) {
  const HandEyePair pair = examplePair();
  HandEyeState state = exampleState(pair);
  state.T_VW = pair.T_VM * (pair.T_WS * state.T_SM).inverse();
  state.offset_s = 0;
  EXPECT_LT(handEyeResidual(pair, state).r.norm(), 1e-14);
}

HandEyeState stepped(HandEyeState state, int k, double h) {
  Vector6d d = Vector6d::Zero();
  if (k < 12) d[k % 6] = h;
  if (k < 6) state.T_SM = boxplus(state.T_SM, d);
  if (k >= 6 && k < 12) state.T_VW = boxplus(state.T_VW, d);
  if (k == 12) state.offset_s += h;
  return state;
}

TEST(HandEyeResidual, JacobiansEqualCentralDifferences) {
  const HandEyePair pair = examplePair();
  const HandEyeState state = exampleState(pair);
  constexpr double h = 1e-6;  // truncation 1e-12, rounding 1e-10
  HandEyeJacobian numeric;
  for (int k = 0; k < kHandEyeColumns; ++k) {
    numeric.col(k) = (handEyeResidual(pair, stepped(state, k, h)).r -
                      handEyeResidual(pair, stepped(state, k, -h)).r) /
                     (2 * h);
  }
  EXPECT_LT((numeric - analytic(pair, state)).cwiseAbs().maxCoeff(), 1e-8) << numeric;
}

HandEyeVec3 handEyeVariable(const Eigen::Vector3d& value, int at) {
  return {HandEyeJet(value(0), at), HandEyeJet(value(1), at + 1), HandEyeJet(value(2), at + 2)};
}

Eigen::Quaternion<HandEyeJet> constant(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return {HandEyeJet(q.w()), HandEyeJet(q.x()), HandEyeJet(q.y()), HandEyeJet(q.z())};
}

Eigen::Quaternion<HandEyeJet> handEyeRotation(const Eigen::Matrix3d& R, int at) {
  return oracle::expQuaternion<HandEyeJet>(handEyeVariable(Eigen::Vector3d::Zero(), at)) *
         constant(R);
}

TEST(HandEyeResidual, JacobiansEqualAutomaticDifferentiation) {
  const HandEyePair pair = examplePair();
  const HandEyeState state = exampleState(pair);
  const auto q_SM = handEyeRotation(state.T_SM.R, 3), q_VW = handEyeRotation(state.T_VW.R, 9);
  const auto q_WS = constant(pair.T_WS.R);
  const HandEyeJet offset(state.offset_s, 12);
  const HandEyeVec3 t_WM = q_WS * handEyeVariable(state.T_SM.t, 0) + pair.T_WS.t.cast<HandEyeJet>();
  const HandEyeVec3 t = q_VW * t_WM + handEyeVariable(state.T_VW.t, 6) -
                        pair.T_VM.t.cast<HandEyeJet>() - offset * pair.v_V.cast<HandEyeJet>();
  const auto q_VM =
      oracle::expQuaternion<HandEyeJet>(HandEyeVec3(offset * pair.omega_V.cast<HandEyeJet>())) *
      constant(pair.T_VM.R);
  const HandEyeVec3 angle =
      oracle::logQuaternion<HandEyeJet>(q_VW * q_WS * q_SM * q_VM.conjugate());
  HandEyeJacobian J;
  for (int k = 0; k < 3; ++k) {
    J.row(k) = t(k).v.transpose();
    J.row(k + 3) = angle(k).v.transpose();
  }
  EXPECT_LT((J - analytic(pair, state)).cwiseAbs().maxCoeff(), 1e-10) << J;
}

}  // namespace
}  // namespace plumbline
