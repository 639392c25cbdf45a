// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/simulate/motion.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// A motion through control poses that may be added while it goes on: a uniform cubic B-spline, of
/// positions in F and, cumulatively, of rotations (Sommer et al., 2020). Twice continuously
/// differentiable; with B the moving frame,
///   p(u) = p_i + sum_{j=1..3} l_j(u) (p_{i+j} - p_{i+j-1}),
///   R(u) = R_i prod_{j=1..3} Exp(l_j(u) Log(R_{i+j-1}^T R_{i+j})),
/// l_1 = (5 + 3u - 3u^2 + u^3) / 6, l_2 = (1 + 3u + 3u^2 - 2u^3) / 6, l_3 = u^3 / 6, u in [0, 1)
/// within segment i = floor(t / spacing). Consecutive rotations differ by less than pi.
class SplineMotion {
 public:
  explicit SplineMotion(double spacing_s) : spacing_s_(spacing_s) {}

  std::size_t size() const { return poses_.size(); }
  void add(const Transform& T_FB) { poses_.push_back(T_FB); }

  /// Until when at() is known: (size - 3) spacing, 0 with fewer than four poses.
  double knownUntilS() const {
    return size() < 4 ? 0 : static_cast<double>(size() - 3) * spacing_s_;
  }

  /// State at t_s, moved into [0, knownUntilS()): beyond its ends the motion is that of the ends.
  /// At least four poses.
  MotionState at(double t_s) const;

 private:
  double spacing_s_;
  std::vector<Transform> poses_;
};

/// What every camera of a rig sees of the target with camera 0 at T_FC0, with the noise that frame
/// `frame` has by `options.seed`.
std::vector<std::vector<Corner>> cornersAt(const SimulatedRig& rig, const Transform& T_FC0,
                                           int frame, const SimulationOptions& options);

/// What a rig measures along a motion of camera 0 that is not known beforehand, frame by frame: the
/// measurements are those that simulateSession() would make along it, with the same random numbers
/// (corners with noise and outliers, IMU samples with noise and bias walk). All cameras expose at
/// the frame's stamp; dropped frames and jitter are not made. Throws InputError for options with
/// faults, rates or a time offset: the latter are the rig's own.
class RigSensors {
 public:
  /// `options.duration_s`: the longest recording.
  RigSensors(const SimulatedRig& rig, const SimulationOptions& options);

  TimeNs stampOf(int frame) const {
    return options_.start_ns + toNanoseconds(frame / rig_.camera_rate_hz);
  }
  double secondsOf(TimeNs t_imu) const { return secondsBetween(options_.start_ns, t_imu); }
  /// When frame `frame` is exposed, in the motion's time (the IMU's clock, 0 at start_ns).
  double exposureS(int frame) const {
    return secondsOf(stampOf(frame)) + rig_.calibration.imu->timeOffset();
  }
  /// Frames of the longest recording.
  int frames() const { return frames_; }

  /// What every camera sees; motion.knownUntilS() reaches exposureS(frame).
  std::vector<std::vector<Corner>> corners(const SplineMotion& motion, int frame) const {
    return cornersAt(rig_, motion.at(exposureS(frame)).T_FB, frame, options_);
  }
  /// Samples that were not taken yet, up to a stamp; the motion is known until then.
  std::vector<ImuSample> samplesUntil(const SplineMotion& motion, TimeNs t);

  const Calibration& truth() const { return rig_.calibration; }
  /// Streams without views and samples, with all that is stated of them.
  Session emptySession() const;

 private:
  struct Noise {
    TimeNs t = 0;
    Eigen::Vector3d gyro, accel;
  };

  SimulatedRig rig_;
  SimulationOptions options_;
  Eigen::Vector3d gravity_F_;
  std::vector<Noise> noise_;
  std::size_t taken_ = 0;
  int frames_ = 0;
};

}  // namespace plumbline
