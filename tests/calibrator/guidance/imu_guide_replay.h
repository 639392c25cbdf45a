// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline::test {

inline GuideRig rigOf(const SimulatedSession& s) {
  GuideRig rig;
  rig.target = s.session.target;
  rig.imu = s.session.imu->noise;
  for (const CameraCalibration& c : s.truth.cameras) {
    rig.cameras.push_back({c.name,
                           c.intrinsics.resolution,
                           {c.intrinsics.projection_model, c.intrinsics.distortion_model}});
  }
  return rig;
}

/// The session as the guide gets it; samples arrive `late_s` after they were taken.
inline std::vector<GuideFrame> framesOf(const Session& session, double late_s = 0.05) {
  FrameOptions pairing;
  pairing.min_corners = 0;
  std::vector<GuideFrame> frames;
  auto sample = session.imu->samples.begin();
  for (const Frame& frame : pairFrames(session.cameras, pairing)) {
    GuideFrame& out = frames.emplace_back();
    out.index = static_cast<int>(frames.size()) - 1;
    out.t = frame.t;
    for (std::size_t c = 0; c < session.cameras.size(); ++c) {
      const int view = frame.view[c];
      out.corners.emplace_back();
      if (view < 0) continue;
      out.corners.back() = session.cameras[c].views[static_cast<std::size_t>(view)].corners;
    }
    const TimeNs until = frame.t + toNanoseconds(late_s);
    for (; sample != session.imu->samples.end() && sample->t <= until; ++sample) {
      out.imu.push_back(*sample);
    }
  }
  return frames;
}

inline std::vector<Decision> replay(CameraImuGuide& guide, const std::vector<GuideFrame>& frames) {
  std::vector<Decision> decisions;
  for (const GuideFrame& frame : frames) decisions.push_back(guide.step(frame));
  return decisions;
}

/// The first decision with a reason; null if there is none.
inline const Decision* firstWith(const std::vector<Decision>& decisions, GuideReason reason) {
  for (const Decision& d : decisions) {
    if (d.reason == reason) return &d;
  }
  return nullptr;
}

inline constexpr double kErrorSigma = 0.2;  // [px]

/// A free motion before rig euroc with corners of that noise.
inline SimulatedSession flight(double duration_s, std::uint64_t seed,
                               std::optional<double> camera_rate_hz = std::nullopt) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.camera_rate_hz = camera_rate_hz;
  options.corner_sigma_px = kErrorSigma;
  options.seed = options.trajectory.seed = seed;
  return simulateSession(simulatedRig("euroc"), options);
}

/// The stage by what points will be off, under the noise of flight().
inline GuideOptions byTrajectoryError() {
  GuideOptions options;
  options.trajectories = GuideOptions::patient().trajectories;
  options.trajectories.pixel_sigma = kErrorSigma;
  options.trajectories.cauchy_px = 0;
  options.trajectories.criterion = ViewCriterion::kPredictedError;
  return options;
}

}  // namespace plumbline::test
