// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/imu_rates.h"

#include <algorithm>
#include <cmath>

#include "calibrator/base/lie.h"

namespace plumbline {

std::vector<CameraRate> cameraRates(std::span<const StampedPose> poses, double max_gap_s) {
  std::vector<CameraRate> rates;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double dt = secondsBetween(poses[i].t, poses[i + 1].t);
    if (dt <= 0 || dt > max_gap_s) continue;
    const Eigen::Matrix3d R = poses[i].T_FC0.R.transpose() * poses[i + 1].T_FC0.R;
    rates.push_back({poses[i].t, poses[i + 1].t, logSO3(R) / dt});
  }
  return rates;
}

GyroIntegral::GyroIntegral(std::span<const ImuSample> samples) : samples_(samples) {
  integral_.reserve(samples.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k > 0) {
      const double dt = secondsBetween(samples[k - 1].t, samples[k].t);
      sum += 0.5 * dt * (samples[k - 1].gyro + samples[k].gyro);
    }
    integral_.push_back(sum);
  }
  if (samples.size() > 1) {
    mean_interval_s_ = secondsBetween(samples.front().t, samples.back().t) /
                       static_cast<double>(samples.size() - 1);
  }
}

Eigen::Vector3d GyroIntegral::at(TimeNs t, double offset_s) const {
  const auto tau = [&](std::size_t k) { return secondsBetween(samples_[k].t, t) + offset_s; };
  const double last = static_cast<double>(samples_.size() - 2);
  auto k = static_cast<std::size_t>(std::clamp(tau(0) / mean_interval_s_, 0.0, last));
  while (k > 0 && tau(k) < 0) --k;
  while (k + 2 < samples_.size() && tau(k + 1) >= 0) ++k;
  const double dt = tau(k);
  const ImuSample& s = samples_[k];
  const ImuSample& next = samples_[k + 1];
  const double step = secondsBetween(s.t, next.t);
  return integral_[k] + dt * (s.gyro + (0.5 * dt / step) * (next.gyro - s.gyro));
}

std::optional<Eigen::Vector3d> GyroIntegral::meanRate(TimeNs from, TimeNs to,
                                                      double offset_s) const {
  if (samples_.size() < 2) return std::nullopt;
  if (secondsBetween(samples_.front().t, from) + offset_s < 0) return std::nullopt;
  if (secondsBetween(to, samples_.back().t) - offset_s < 0) return std::nullopt;
  return (at(to, offset_s) - at(from, offset_s)) / secondsBetween(from, to);
}

std::vector<RatePair> pairRates(std::span<const CameraRate> camera, const GyroIntegral& gyro,
                                double offset_s) {
  std::vector<RatePair> pairs;
  pairs.reserve(camera.size());
  for (const CameraRate& c : camera) {
    const auto rate = gyro.meanRate(c.from, c.to, offset_s);
    if (rate) pairs.push_back({*rate, c.rate_C});
  }
  return pairs;
}

}  // namespace plumbline
