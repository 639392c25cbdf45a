// SPDX-License-Identifier: BSD-3-Clause
// A recording of eight seconds and what the camera-IMU stage makes of it.
#pragma once

#include <algorithm>
#include <vector>

#include "calibrator/guidance/guide.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline::test::imu_flight {

inline constexpr double kImuGuideSigma = 0.2;  // [px]

inline SimulatedSession simulated(double duration_s) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.corner_sigma_px = kImuGuideSigma;
  options.seed = options.trajectory.seed = 1;
  return simulateSession(simulatedRig("euroc"), options);
}

/// Shared by the tests, for simulation takes longer than the guide.
inline const SimulatedSession& imuGuideRecording() {
  static const SimulatedSession s = simulated(8);
  return s;
}

/// Squared error and the noise that was simulated; a threshold that 8 s of recording reach.
inline GuideOptions matched() {
  GuideOptions options;
  options.trajectories = GuideOptions::patient().trajectories;
  options.trajectories.pixel_sigma = kImuGuideSigma;
  options.trajectories.cauchy_px = 0;
  options.trajectories.threshold_nats = 1.2;
  return options;
}

inline CameraImuGuide guideFor(const SimulatedSession& s, const GuideOptions& options) {
  return {rigOf(s), s.truth.cameras, options};
}

struct ImuReplay {
  std::vector<Decision> decisions;
  CameraImuGuide guide;
};
inline ImuReplay imuReplayed(const std::vector<GuideFrame>& imuFrames,
                             const GuideOptions& options = matched()) {
  ImuReplay r{{}, guideFor(imuGuideRecording(), options)};
  r.decisions = replay(r.guide, imuFrames);
  return r;
}
inline std::vector<GuideFrame> imuFrames() { return framesOf(imuGuideRecording().session); }

/// A threshold that is never reached: the guide goes on to the recording's end.
inline GuideOptions endless() {
  GuideOptions options = matched();
  options.trajectories.threshold_nats = 0;
  return options;
}

inline int countIn(const std::vector<Decision>& decisions, GuideReason reason) {
  return static_cast<int>(
      std::count_if(decisions.begin(), decisions.end(),
                    [reason](const Decision& d) { return d.reason == reason; }));
}

}  // namespace plumbline::test::imu_flight
