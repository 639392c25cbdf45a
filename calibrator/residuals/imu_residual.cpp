// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/imu_residual.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

// The difference of two neighbours would be their noise more than a slope.
constexpr std::ptrdiff_t kSlopeReach = 2;  // samples on either side

using Columns = Eigen::Matrix<double, 3, SampleFaults::kCount>;

/// Seconds from the window's begin to a stamp.
double secondsAfter(const ImuWindow& window, TimeNs t) {
  return secondsBetween(window.from, t) - window.time_offset_s;
}

/// d(accel)/dt around the interval that ends at `next`.
Eigen::Vector3d slopeAround(std::span<const ImuSample> samples, std::ptrdiff_t next) {
  const auto last = static_cast<std::ptrdiff_t>(samples.size()) - 1;
  const auto a = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - 1 - kSlopeReach, 0));
  const auto b = static_cast<std::size_t>(std::min(next + kSlopeReach, last));
  return (samples[b].accel - samples[a].accel) / secondsBetween(samples[a].t, samples[b].t);
}

/// Changes of rate and force, in S_i, as a unit of every fault is taken off the samples: with
/// M = E_rc the rate loses e_r w_c, hence the minus. The delay's column is left to the caller: the
/// force at t is read at t + d, so that it changes by + d times the slope.
void addChanges(const Eigen::Matrix3d& R, const Eigen::Vector3d& w, const Eigen::Vector3d& a,
                Columns& dw, Columns& da) {
  dw.setZero();
  da.setZero();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      da.col(SampleFaults::kAccel + 3 * r + c) = -R.col(r) * a(c);
      dw.col(SampleFaults::kGyro + 3 * r + c) = -R.col(r) * w(c);
      dw.col(SampleFaults::kGSensitivity + 3 * r + c) = -R.col(r) * a(c);
    }
  }
}

}  // namespace

ImuState boxplus(const ImuState& state, const Vector15d& d) {
  ImuState out;
  out.T_FS = boxplus(state.T_FS, Vector6d(d.head<6>()));
  out.v_F = state.v_F + d.segment<3>(6);
  out.gyro_bias = state.gyro_bias + d.segment<3>(9);
  out.accel_bias = state.accel_bias + d.segment<3>(12);
  return out;
}

Vector15d boxminus(const ImuState& to, const ImuState& from) {
  Vector15d d;
  d << boxminus(to.T_FS, from.T_FS), to.v_F - from.v_F, to.gyro_bias - from.gyro_bias,
      to.accel_bias - from.accel_bias;
  return d;
}

// Right-handed: col(0) x col(1) = direction. Not continuous in the direction (unitOrthogonal()
// picks axes), so that coordinates are of use only with the basis at the same direction.
Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.unitOrthogonal();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

// Along the great circle, so that a long step stays on the sphere.
Eigen::Vector3d boxplusDirection(const Eigen::Vector3d& direction, const Eigen::Vector2d& d) {
  const double angle = d.norm();
  // d / angle has no direction; to first order it is the same.
  if (angle < 1e-12) return (direction + tangentBasis(direction) * d).normalized();
  const Eigen::Vector3d towards = tangentBasis(direction) * (d / angle);
  return (std::cos(angle) * direction + std::sin(angle) * towards).normalized();
}

ImuResidual imuResidual(const Preintegration& motion, const ImuState& i, const ImuState& j,
                        const Gravity& gravity) {
  const double T = motion.duration_s;
  const Eigen::Vector3d g = gravity.magnitude * gravity.direction;
  const Eigen::Matrix3d R_SF = i.T_FS.R.transpose();
  const Eigen::Vector3d dv = j.v_F - i.v_F - g * T;
  const Eigen::Vector3d dp = j.T_FS.t - i.T_FS.t - i.v_F * T - g * (0.5 * T * T);
  // (dv, dp: what the states say of the motion, gravity taken off, in F.)
  // The whole logarithm: the paper's orientation error, twice the vector part of the quaternion, is
  // the same up to second order in the angle.
  const Eigen::Vector3d r_R = logSO3(motion.R.transpose() * R_SF * j.T_FS.R);

  ImuResidual out;
  out.r << r_R, R_SF * dv - motion.v, R_SF * dp - motion.p;

  // R_i' Exp(a) R_j = R_i' R_j Exp(R_j' a): a turn of either frame acts on the right of r_R's
  // rotation, with opposite signs. The bias, dR(b + d) = dR Exp(R_bg d), acts on its left.
  // R_i <- Exp(a) R_i makes R_i' dv into R_i' (dv - a x dv): + R_i' [dv]x. The motion's own
  // derivatives enter with a minus, for the residual is states minus motion; t_d acts on R as the
  // bias does.
  const Eigen::Matrix3d J_R = inverseRightJacobianSO3(r_R) * j.T_FS.R.transpose();
  const Eigen::Matrix3d J_left = inverseLeftJacobianSO3(r_R);
  out.J_i.setZero();
  out.J_i.block<3, 3>(0, 3) = -J_R;
  out.J_i.block<3, 3>(0, 9) = -J_left * motion.R_bg;
  out.J_i.block<3, 3>(3, 3) = R_SF * skew(dv);
  out.J_i.block<3, 3>(3, 6) = -R_SF;
  out.J_i.block<3, 3>(3, 9) = -motion.v_bg;
  out.J_i.block<3, 3>(3, 12) = -motion.v_ba;
  out.J_i.block<3, 3>(6, 0) = -R_SF;
  out.J_i.block<3, 3>(6, 3) = R_SF * skew(dp);
  out.J_i.block<3, 3>(6, 6) = -R_SF * T;
  out.J_i.block<3, 3>(6, 9) = -motion.p_bg;
  out.J_i.block<3, 3>(6, 12) = -motion.p_ba;

  out.J_j.setZero();
  out.J_j.block<3, 3>(0, 3) = J_R;
  out.J_j.block<3, 3>(3, 6) = R_SF;
  out.J_j.block<3, 3>(6, 0) = R_SF;

  const Eigen::Matrix<double, 3, 2> g_basis = gravity.magnitude * tangentBasis(gravity.direction);
  out.J_gravity.setZero();
  out.J_gravity.middleRows<3>(3) = -T * (R_SF * g_basis);
  out.J_gravity.bottomRows<3>() = (-0.5 * T * T) * (R_SF * g_basis);
  // In closed form, where the paper perturbs the stamps (central differences).
  out.J_offset << -J_left * motion.R_td, -motion.v_td, -motion.p_td;
  return out;
}

Vector6d biasWalkResidual(const ImuState& i, const ImuState& j) {
  Vector6d r;
  r << j.gyro_bias - i.gyro_bias, j.accel_bias - i.accel_bias;
  return r;
}

Vector6d ImuWeight::walk() const {
  Vector6d rows;
  rows << Eigen::Vector3d::Constant(gyro_walk), Eigen::Vector3d::Constant(accel_walk);
  return rows;
}

ImuWeight biasWalkWeight(const ImuNoise& noise, double duration_s) {
  assert(duration_s > 0);
  ImuWeight weight;
  // A random walk's variance grows with time, density^2 T.
  weight.gyro_walk = 1 / (noise.gyro_random_walk * std::sqrt(duration_s));
  weight.accel_walk = 1 / (noise.accel_random_walk * std::sqrt(duration_s));
  return weight;
}

ImuWeight imuWeight(const Matrix9d& covariance, const ImuNoise& noise, double duration_s) {
  ImuWeight weight = biasWalkWeight(noise, duration_s);
  const Eigen::LLT<Matrix9d> llt(covariance);
  assert(llt.info() == Eigen::Success);
  // L^-1 of Sigma = L L': |L^-1 r|^2 = r' Sigma^-1 r.
  weight.sqrt_information.setIdentity();
  llt.matrixL().solveInPlace(weight.sqrt_information);
  return weight;
}

std::optional<Eigen::Matrix<double, 9, SampleFaults::kCount>> sampleFaultDerivatives(
    std::span<const ImuSample> samples, const ImuWindow& window, const ImuBias& bias) {
  const double end = window.duration_s();
  const auto first = std::partition_point(samples.begin(), samples.end(), [&](const ImuSample& s) {
    return secondsAfter(window, s.t) <= 0;
  });
  if (first == samples.begin() || first == samples.end()) return std::nullopt;
  Columns psi = Columns::Zero(), v = Columns::Zero(), p = Columns::Zero();
  Columns dw, da;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double at = 0;
  for (auto next = first; at < end; ++next) {
    if (next == samples.end()) return std::nullopt;
    const ImuSample& s0 = *(next - 1);
    const double t0 = secondsAfter(window, s0.t);
    const double t1 = secondsAfter(window, next->t);
    const double to = std::min(t1, end);
    const double dt = to - at;
    // Of the midpoint within its sample interval, whose readings are joined linearly.
    const double share = (0.5 * (at + to) - t0) / (t1 - t0);
    const Eigen::Vector3d w = s0.gyro + share * (next->gyro - s0.gyro) - bias.gyro;
    const Eigen::Vector3d a = s0.accel + share * (next->accel - s0.accel) - bias.accel;
    const Eigen::Matrix3d R_mid = R * expSO3(0.5 * dt * w);
    addChanges(R_mid, w, a, dw, da);
    da.col(SampleFaults::kDelay) = R_mid * slopeAround(samples, next - samples.begin());
    // psi at the middle of the interval, as the force is taken there.
    const Columns psi_mid = psi + 0.5 * dt * dw;
    const Columns acceleration = da - skew(R_mid * a) * psi_mid;
    p += dt * v + 0.5 * dt * dt * acceleration;
    v += dt * acceleration;
    psi += dt * dw;
    R *= expSO3(dt * w);
    at = to;
  }
  Eigen::Matrix<double, 9, SampleFaults::kCount> out;
  // From a turn in S_i on the left to one on the right: R' psi.
  out << R.transpose() * psi, v, p;
  return out;
}

}  // namespace plumbline
