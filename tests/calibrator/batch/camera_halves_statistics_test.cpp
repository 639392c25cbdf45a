// SPDX-License-Identifier: BSD-3-Clause
// How often halves that agree are said not to.
#include <gtest/gtest.h>

#include "calibrator/batch/halves.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

TEST(CameraHalvesStatistics, WhiteNoiseIsRarelyADisagreement) {
  constexpr int kSeeds = 60;
  int blocks = 0, alarms = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    SimulationOptions recording;
    recording.seed = static_cast<std::uint64_t>(seed);
    recording.trajectory.seed = recording.seed;
    recording.duration_s = 20;
    recording.camera_rate_hz = 5;
    const SimulatedSession s = simulateSession(simulatedRig("euroc"), recording);
    CameraStageOptions options;
    options.pixel_sigma = 0.2;
    options.cauchy_px = 0;
    const auto whole = calibrateCameras(s.session, options);
    ASSERT_TRUE(whole.ok()) << seed;
    const auto check = checkCameraHalves(s.session, *whole, options);
    ASSERT_TRUE(check) << seed;
    for (const HalvesBlock& b : check->blocks) {
      ++blocks;
      alarms += b.agree() ? 0 : 1;
    }
  }
  EXPECT_EQ(blocks, 3 * kSeeds);
  EXPECT_LE(alarms, 6);  // 1 % of 180 is 1.8; more than 6 has a chance of 0.3 %
}

}  // namespace
}  // namespace plumbline
