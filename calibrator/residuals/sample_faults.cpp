// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "calibrator/base/transform.h"
#include "calibrator/residuals/imu_residual.h"

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
