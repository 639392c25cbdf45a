// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
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

/// What the accelerometer and the camera's motion say together, by linear least squares. Standard
/// deviations take the triples as independent: those of short recordings overlap, and what their
/// noise has in common is not seen.
struct InertialAlignment {
  double scale = 1;      ///< metres per metre of the stated target; 0.5: tags stated 2 x too large
  double scale_std = 0;  ///< from the residuals
  Eigen::Vector3d t_SC0 = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d gravity_F = Eigen::Vector3d::Zero();  ///< [m/s^2], pointing down
  double gravity_std = 0;  ///< of its magnitude, from the residuals [m/s^2]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  double residual_rms = 0;  ///< per component [m/s^2], over windows of about 2 span_s
  double fixed_rms = 0;     ///< the same with the scale held at 1
  /// What noise of poses and IMU explains of it, in metres of the stated target: times the scale
  /// comparable with residual_rms (residualRatio()); 0: not known.
  double noise_rms = 0;
  int equations = 0;  ///< vector equations used
};

/// Solves for scale s, t_SC0, gravity and accelerometer bias from triples of frames a, b, c: the
/// second difference of the IMU's position, p_S = s p_C0 - R_FS t_SC0, equals gravity plus the
/// pre-integrated force (velocities eliminated). Needs the rotation, gyro bias and time offset of
/// the rates' alignment. Triples that leave more than 6 robust standard deviations are left out (a
/// pose that is wrong spoils a few). `noise` is that of noise_rms. Where the camera does not
/// accelerate enough for 1 / s to differ from zero by four deviations, s is held at 1; its
/// deviation stays that of the free one. Empty for fewer than 10 usable triples.
std::optional<InertialAlignment> alignInertially(std::span<const CameraPose> poses,
                                                 std::span<const ImuSample> samples,
                                                 const Eigen::Matrix3d& R_SC0,
                                                 const Eigen::Vector3d& gyro_bias,
                                                 double time_offset_s, const ImuNoise& noise = {});

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
