// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "calibrator/base/error.h"
#include "calibrator/initialise/angular_rates.h"

namespace plumbline {

/// Rotation between gyro and camera from their rates: minimises
/// sum |gyro_S - (R_SC0 camera_C + gyro_bias)|^2 (Wahba's problem on centred rates, by SVD).
struct RateAlignment {
  Eigen::Matrix3d R_SC0 = Eigen::Matrix3d::Identity();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  /// Cosine between the centred rates after the best rotation, in [0, 1]; it does not depend on
  /// units. 1: the rates are rotated copies of each other.
  double correlation = 0;
  double mirrored_correlation = 0;  ///< the same for the best reflection: axes of the wrong hand
  double gyro_to_camera = 1;        ///< RMS of the gyro's centred rates over the camera's
  /// RMS of the gyro's centred rate along its principal axes, descending [rad/s], and those axes in
  /// S (columns).
  Eigen::Vector3d excitation = Eigen::Vector3d::Zero();
  Eigen::Matrix3d excitation_axes = Eigen::Matrix3d::Identity();
  int pairs = 0;
};
/// All zero (and identity) for fewer than 3 pairs or rates that do not vary.
RateAlignment alignRates(std::span<const RatePair> pairs);

struct TimeOffsetOptions {
  double max_offset_s = 1.0;    ///< search range, both ways [s]
  double coarse_step_s = 0.01;  ///< step of the search; a fifth of the fastest motion's period
  double min_overlap = 0.5;     ///< part of what the gyro covers under the best-covered offset
                                ///< that it must cover under the chosen one [0..1]
  int min_pairs = 20;           ///< rates below which no correlation is attempted

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

struct TimeOffsetEstimate {
  double offset_s = 0;   ///< t_imu = t_cam + offset_s
  bool at_edge = false;  ///< an end of the range correlates as well, or the best is beyond
  RateAlignment alignment;
};

/// Finds the offset at which the correlation of RateAlignment (the better of rotation and
/// reflection) is greatest: a grid over the whole range, then parabolas around its best points.
/// Accurate to about a hundredth of a frame interval. Fails with kTooFewViews where the
/// camera has too few rates, with kNoOverlap where the streams share too little time.
Result<TimeOffsetEstimate> estimateTimeOffset(std::span<const CameraRate> camera,
                                              const GyroIntegral& gyro,
                                              const TimeOffsetOptions& options = {});

/// The offsets of two parts of a recording by themselves: those that differ most by their
/// deviations.
struct PartOffsets {
  double least_s = 0;
  double most_s = 0;
  double std_s = 0;  ///< of their difference, by what the rates leave
};

/// Up to ten parts of the recording, of at least 30 rates, each aligned by itself within 0.5 s of
/// `offset_s`. Empty where fewer than half of them correlate above 0.95 under one rotation: then
/// they are not of one motion.
std::optional<PartOffsets> offsetsOfParts(std::span<const CameraRate> camera,
                                          const GyroIntegral& gyro, double offset_s);

}  // namespace plumbline
