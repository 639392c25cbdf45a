// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/simulate/operator/spline_motion.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// What every camera of a rig sees of the target with camera 0 at T_FC0, with the noise that frame
/// `frame` has by `options.seed`.
std::vector<std::vector<Corner>> cornersAt(const SimulatedRig& rig, const Transform& T_FC0,
                                           int frame, const SimulationOptions& options);

/// What a rig measures along a motion of camera 0 that is not known beforehand, frame by frame: the
/// measurements are those that simulateSession() would make along it, with the same random numbers
/// (corners with noise and outliers, IMU samples with noise and bias walk). All cameras expose at
/// the frame's stamp; faults, dropped frames and jitter are not made.
class RigSensors {
 public:
  /// `options.duration_s`: the longest recording.
  RigSensors(const SimulatedRig& rig, const SimulationOptions& options);

  TimeNs stampOf(int frame) const;
  double secondsOf(TimeNs t_imu) const { return secondsBetween(options_.start_ns, t_imu); }
  /// When frame `frame` is exposed, in the motion's time (the IMU's clock, 0 at start_ns).
  double exposureS(int frame) const;
  /// Frames of the longest recording.
  int frames() const { return frames_; }

  /// What every camera sees; motion.knownUntilS() reaches exposureS(frame).
  std::vector<std::vector<Corner>> corners(const SplineMotion& motion, int frame) const;
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
