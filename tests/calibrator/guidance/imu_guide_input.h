// SPDX-License-Identifier: BSD-3-Clause
// A recording of eight seconds that tests of bad input spoil, and what the camera-IMU stage makes
// of it.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline::test::imu_input {

inline const SimulatedSession& inputRecording() {
  static const SimulatedSession s = [] {
    SimulationOptions options;
    options.duration_s = 8;
    options.seed = options.trajectory.seed = 1;
    return simulateSession(simulatedRig("euroc"), options);
  }();
  return s;
}

struct Replay {
  std::vector<Decision> decisions;
  CameraImuGuide guide;
};
inline Replay replayed(const std::vector<GuideFrame>& frames) {
  GuideOptions options;
  options.trajectories.pixel_sigma = 0.2;
  options.trajectories.cauchy_px = 0;
  options.trajectories.threshold_nats = 0;  // it goes on to the end
  Replay r{{}, {rigOf(inputRecording()), inputRecording().truth.cameras, options}};
  r.decisions = replay(r.guide, frames);
  return r;
}

inline std::vector<GuideFrame> frames() { return framesOf(inputRecording().session); }

/// Without the target from one frame to another, but in the one that is `seen`; -1: in none.
inline std::vector<GuideFrame> framesWithout(int from, int to, int seen = -1) {
  auto all = frames();
  for (int i = from; i < to; ++i) {
    if (i == seen) continue;
    for (auto& corners : all[static_cast<std::size_t>(i)].corners) corners.clear();
  }
  return all;
}

inline int count(const std::vector<Decision>& decisions, GuideReason reason) {
  return static_cast<int>(
      std::count_if(decisions.begin(), decisions.end(),
                    [reason](const Decision& d) { return d.reason == reason; }));
}

/// Frames accepted, less those withdrawn later.
inline int keptBy(const std::vector<Decision>& decisions) {
  int kept = 0;
  for (const Decision& d : decisions) {
    kept += (d.accepted ? 1 : 0) - static_cast<int>(d.withdrawn.size());
  }
  return kept;
}

/// Frames used well after the fault, and the truth within the batch's covariance.
inline void expectItWentOn(const Replay& r, std::size_t after) {
  int used = 0;
  for (std::size_t i = after; i < r.decisions.size(); ++i) {
    if (r.decisions[i].reason == GuideReason::kUsed) ++used;
    if (r.decisions[i].rmse_px) {
      EXPECT_LT(*r.decisions[i].rmse_px, 0.6);
    }
  }
  EXPECT_GT(used, static_cast<int>(r.decisions.size() - after) / 2);
  const auto result = r.guide.batch();
  ASSERT_TRUE(result) << result.failure();
  const Vector6d error = boxminus(inputRecording().truth.imu->T_SC0, result->imu.T_SC0);
  const Eigen::MatrixXd covariance = result->summary.covariance.matrix.topLeftCorner(6, 6);
  EXPECT_LT(error.dot(covariance.llt().solve(error)), 22.46);  // 6 dof, 99.9 %
}

}  // namespace plumbline::test::imu_input
