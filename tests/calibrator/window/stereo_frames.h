// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline::test {

/// Frames of a simulated recording as a window takes them.
struct StereoFrames {
  SimulatedSession simulated;
  std::vector<TimeNs> t;
  std::vector<std::vector<std::vector<Corner>>> corners;  ///< per frame, per camera
  std::vector<Transform> T_FC0;                           ///< the truth
};

inline StereoFrames framesOf(SimulatedSession simulated) {
  StereoFrames out{std::move(simulated), {}, {}, {}};
  const std::vector<CameraStream>& cameras = out.simulated.session.cameras;
  for (const Frame& frame : pairFrames(cameras)) {
    std::vector<std::vector<Corner>> corners(cameras.size());
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (frame.view[c] >= 0) {
        corners[c] = cameras[c].views[static_cast<std::size_t>(frame.view[c])].corners;
      }
    }
    out.t.push_back(frame.t);
    out.corners.push_back(std::move(corners));
    out.T_FC0.push_back(out.simulated.cameraPose(0, frame.t));
  }
  return out;
}

/// Of a rig in free motion, `rate_hz` frames a second.
inline StereoFrames stereoFrames(std::uint64_t seed, double duration_s, double rate_hz,
                                 double sigma_px, const std::string& rig = "euroc") {
  SimulationOptions options;
  options.seed = seed;
  options.trajectory.seed = seed;
  options.duration_s = duration_s;
  options.camera_rate_hz = rate_hz;
  options.corner_sigma_px = sigma_px;
  return framesOf(simulateSession(simulatedRig(rig), options));
}

}  // namespace plumbline::test
