// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/angular_rates.h"

#include <algorithm>
#include <utility>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

std::vector<CameraRate> cameraRates(std::span<const CameraPose> poses, double max_gap_s) {
  std::vector<CameraRate> rates;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double dt = secondsBetween(poses[i].t, poses[i + 1].t);
    if (dt <= 0 || dt > max_gap_s) continue;
    // In the camera's own frame F drops out: how the target stands does not matter.
    const Eigen::Matrix3d R = poses[i].T_FC0.R.transpose() * poses[i + 1].T_FC0.R;
    rates.push_back({poses[i].t, poses[i + 1].t, logSO3(R) / dt});
  }
  return rates;
}

double medianSampleInterval(std::span<const ImuSample> samples) {
  if (samples.size() < 2) return 0;
  std::vector<double> intervals;
  intervals.reserve(samples.size());
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    intervals.push_back(secondsBetween(samples[k].t, samples[k + 1].t));
  }
  // Not the mean, which gaps would lengthen: by this interval gaps are found.
  return median(std::move(intervals));
}

GyroIntegral::GyroIntegral(std::span<const ImuSample> samples) : samples_(samples) {
  integral_.reserve(samples.size());
  gaps_.reserve(samples.size());
  const double longest = kGapIntervals * medianSampleInterval(samples);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int gaps = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    integral_.push_back(sum);
    if (k + 1 < samples.size()) {
      const double dt = secondsBetween(samples[k].t, samples[k + 1].t);
      // Trapezoids: the integral is of the rates as they are joined linearly, exact at any instant.
      sum += 0.5 * dt * (samples[k].gyro + samples[k + 1].gyro);
      if (dt > longest) ++gaps;
    }
    gaps_.push_back(gaps);
  }
  if (samples.size() > 1) {
    mean_interval_s_ = secondsBetween(samples.front().t, samples.back().t) /
                       static_cast<double>(samples.size() - 1);
  }
}

std::size_t GyroIntegral::before(TimeNs t, double offset_s) const {
  constexpr int kSteps = 16;  // how far from the guess a search step by step is worth it
  const auto tau = [&](std::size_t k) { return secondsBetween(samples_[k].t, t) + offset_s; };
  const std::size_t last = samples_.size() - 2;
  // Samples come at a nearly constant rate, so the guess by it is a step or two off; the search is
  // the hot loop of the offset's grid, which asks thousands of times.
  auto k = static_cast<std::size_t>(
      std::clamp(tau(0) / mean_interval_s_, 0.0, static_cast<double>(last)));
  int steps = 0;
  for (; k > 0 && tau(k) < 0 && steps < kSteps; ++steps) --k;
  for (; k < last && tau(k + 1) >= 0 && steps < kSteps; ++steps) ++k;
  if (steps < kSteps) return k;
  const TimeNs at = t + toNanoseconds(offset_s);
  const auto next = std::ranges::upper_bound(samples_, at, {}, &ImuSample::t);
  const auto index = static_cast<std::size_t>(next - samples_.begin());
  return std::min(index == 0 ? 0 : index - 1, last);
}

Eigen::Vector3d GyroIntegral::at(std::size_t k, TimeNs t, double offset_s) const {
  const double dt = secondsBetween(samples_[k].t, t) + offset_s;
  const ImuSample& s = samples_[k];
  const ImuSample& next = samples_[k + 1];
  const double step = secondsBetween(s.t, next.t);
  // The rate is linear between k and k + 1: int = dt w_k + dt^2 / (2 step) (w_k+1 - w_k).
  return integral_[k] + dt * (s.gyro + (0.5 * dt / step) * (next.gyro - s.gyro));
}

std::optional<Eigen::Vector3d> GyroIntegral::meanRate(TimeNs from, TimeNs to,
                                                      double offset_s) const {
  if (samples_.size() < 2) return std::nullopt;
  if (secondsBetween(samples_.front().t, from) + offset_s < 0) return std::nullopt;
  if (secondsBetween(to, samples_.back().t) - offset_s < 0) return std::nullopt;
  const std::size_t first = before(from, offset_s);
  const std::size_t last = before(to, offset_s);
  // gaps_[k] counts up to the interval that begins at k: of intervals first .. last none is a gap.
  // A mean across a pause of the samples is no measurement.
  if (gaps_[last] != (first == 0 ? 0 : gaps_[first - 1])) return std::nullopt;
  return (at(last, to, offset_s) - at(first, from, offset_s)) / secondsBetween(from, to);
}

std::optional<GyroIntegral::RateSlope> GyroIntegral::meanRateSlope(TimeNs from, TimeNs to,
                                                                   double offset_s,
                                                                   double apart_s) const {
  const auto at = meanRate(from, to, offset_s);
  const auto before = meanRate(from, to, offset_s - apart_s);
  const auto after = meanRate(from, to, offset_s + apart_s);
  if (!at || !before || !after) return std::nullopt;
  return RateSlope{*at, (*after - *before) / (2 * apart_s)};
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
