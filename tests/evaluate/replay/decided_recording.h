// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/replay/frames.h"

namespace plumbline {

/// A simulated stereo recording and decisions on it that a test makes up.
class DecidedRecording : public ::testing::Test {
 protected:
  DecidedRecording(double duration_s, double camera_rate_hz)
      : recording_(simulated(duration_s, camera_rate_hz)) {}

  ReplayRun run() const { return {recording_.session, frames_, decisions_, {}, {}, {}}; }

  /// The cameras from the frames that their stage has kept.
  Result<CameraStageResult> keptCameras(const ReplayRun& r) const {
    return calibrateCameras(r.sessionOfFrames(r.accepted(GuideStage::kCamera)));
  }

  SimulatedSession recording_;
  std::vector<GuideFrame> frames_ = guideFrames(recording_.session);
  std::vector<Decision> decisions_;

 private:
  static SimulatedSession simulated(double duration_s, double camera_rate_hz) {
    SimulationOptions options;
    options.duration_s = duration_s;
    options.camera_rate_hz = camera_rate_hz;
    return simulateSession(simulatedRig("euroc"), options);
  }
};

}  // namespace plumbline
