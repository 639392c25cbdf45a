// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "calibrator/base/session.h"
#include "calibrator/residuals/preintegration.h"

namespace plumbline {

/// A piece of a window between two neighbouring samples (or a window's end): rates w [rad/s] and
/// forces a [m/s^2] at its ends, and their derivatives by t_d, which move only the window's ends.
struct ImuSegment {
  double dt = 0;  ///< [s]
  Eigen::Vector3d w0, a0, w1, a1;
  bool first = false;  ///< starts at the window's start
  bool last = false;   ///< ends at the window's end
  Eigen::Vector3d w_slope, a_slope;
};

/// Index k of the sample interval [t_k, t_k+1] that holds from + t_d; 0 .. size - 2.
inline std::size_t segmentStart(std::span<const ImuSample> samples, const ImuWindow& window) {
  const TimeNs start = window.from + toNanoseconds(window.time_offset_s);
  const auto after = std::upper_bound(samples.begin(), samples.end(), start,
                                      [](TimeNs t, const ImuSample& s) { return t < s.t; });
  auto k = static_cast<std::ptrdiff_t>(after - samples.begin()) - 1;
  k = std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(samples.size()) - 2);
  return static_cast<std::size_t>(k);
}

/// Calls visit(const ImuSegment&) along a window, in time order. False, without a call, where the
/// samples do not cover it. All times are relative to the window's start, so that no precision is
/// lost to the epoch.
template <class Visit>
bool forEachSegment(std::span<const ImuSample> samples, const ImuWindow& window, Visit&& visit) {
  if (samples.size() < 2) return false;
  const auto tau = [&](std::size_t k) {
    return secondsBetween(window.from, samples[k].t) - window.time_offset_s;
  };
  const double duration = window.duration_s();
  if (tau(0) > 0 || tau(samples.size() - 1) < duration) return false;
  std::size_t k = segmentStart(samples, window);
  while (k > 0 && tau(k) > 0) --k;
  while (k + 2 < samples.size() && tau(k + 1) <= 0) ++k;

  ImuSegment s;
  double t = 0;
  for (s.first = true; !s.last; s.first = false, ++k) {
    const ImuSample& from = samples[k];
    const ImuSample& to = samples[k + 1];
    const double t0 = tau(k);
    const double t1 = tau(k + 1);
    s.last = t1 >= duration;
    const double end = s.last ? duration : t1;
    s.dt = end - t;
    s.w_slope = (to.gyro - from.gyro) / (t1 - t0);
    s.a_slope = (to.accel - from.accel) / (t1 - t0);
    s.w0 = s.first ? Eigen::Vector3d(from.gyro + s.w_slope * (t - t0)) : from.gyro;
    s.a0 = s.first ? Eigen::Vector3d(from.accel + s.a_slope * (t - t0)) : from.accel;
    s.w1 = s.last ? Eigen::Vector3d(from.gyro + s.w_slope * (end - t0)) : to.gyro;
    s.a1 = s.last ? Eigen::Vector3d(from.accel + s.a_slope * (end - t0)) : to.accel;
    visit(s);
    t = end;
  }
  return true;
}

}  // namespace plumbline
