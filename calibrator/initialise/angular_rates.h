// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// Pose of camera 0 at a frame's stamp (camera clock).
struct CameraPose {
  TimeNs t = 0;
  Transform T_FC0;
  double position_variance = 0;  ///< by the corners' noise, per axis [m^2]; 0: not known
  double rotation_variance = 0;  ///< likewise [rad^2]
};

/// A pause between samples longer than this many times their median interval is a gap.
constexpr double kGapIntervals = 5;

/// Median interval between samples [s]; 0 for fewer than two.
double medianSampleInterval(std::span<const ImuSample> samples);

/// Mean angular rate of camera 0 between two neighbouring frames, in its own frame:
/// Log(R_FC0(from)^T R_FC0(to)) / (to - from) [rad/s].
struct CameraRate {
  TimeNs from = 0;
  TimeNs to = 0;
  Eigen::Vector3d rate_C = Eigen::Vector3d::Zero();
};

/// Rates of all neighbours at most `max_gap_s` apart; `poses` ascend in time.
std::vector<CameraRate> cameraRates(std::span<const CameraPose> poses, double max_gap_s);

/// Integral of the measured gyro rate (trapezoids), with which mean rates over any window cost two
/// look-ups. Keeps a view of `samples`, which must outlive it.
class GyroIntegral {
 public:
  explicit GyroIntegral(std::span<const ImuSample> samples);

  /// Mean measured rate [rad/s] over [from + offset_s, to + offset_s]; empty where not covered, or
  /// where a gap between samples lies within.
  std::optional<Eigen::Vector3d> meanRate(TimeNs from, TimeNs to, double offset_s) const;

  /// The same with its slope over the offset, from offsets `apart_s` to either side [rad/s^2].
  struct RateSlope {
    Eigen::Vector3d rate, slope;
  };
  std::optional<RateSlope> meanRateSlope(TimeNs from, TimeNs to, double offset_s,
                                         double apart_s) const;

  std::span<const ImuSample> samples() const { return samples_; }

 private:
  /// Index of the sample before `t` + offset_s (or of the first, or the last but one).
  std::size_t before(TimeNs t, double offset_s) const;
  /// Integral from the first sample to `t` + offset_s, with k = before(t, offset_s).
  Eigen::Vector3d at(std::size_t k, TimeNs t, double offset_s) const;

  std::span<const ImuSample> samples_;
  std::vector<int> gaps_;  ///< of each sample: gaps before the one that follows it
  std::vector<Eigen::Vector3d> integral_;
  double mean_interval_s_ = 0;
};

/// A pair of rates over the same span of time.
struct RatePair {
  Eigen::Vector3d gyro_S = Eigen::Vector3d::Zero();
  Eigen::Vector3d camera_C = Eigen::Vector3d::Zero();
};

/// Pairs camera rates with the gyro's mean rate under a time offset; uncovered ones are left out.
std::vector<RatePair> pairRates(std::span<const CameraRate> camera, const GyroIntegral& gyro,
                                double offset_s);

}  // namespace plumbline
