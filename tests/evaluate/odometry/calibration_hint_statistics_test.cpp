// SPDX-License-Identifier: BSD-3-Clause
// The odometry's hints on simulated flights: what is wrong in the calibration is found, within
// deviations that are far smaller.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "evaluate/odometry/calibration_hint.h"
#include "tests/calibrator/odometry/room_flight.h"

namespace plumbline {
namespace {

using Eigen::VectorXd;

// With a short window and half the frames: deviations grow with fewer tracks, frames and keyframes,
// and errors are judged by them.
std::optional<CalibrationHint> hintOf(const RoomFlight& flight, const Calibration& calibration,
                                      HintKind kind) {
  OdometryOptions options;
  options.keyframes = 5;
  options.recent_frames = 3;
  const auto run = [&](const VectorXd& change) {
    Odometry odometry(RigModel::of(changed(calibration, change)), flight.samples, options);
    for (const FrameTracks& frame : flight.frames) odometry.step(frame);
    return odometry.result().innovations;
  };
  return calibrationHint(kind, run).hint;
}

RoomFlight flightOf(const SimulatedRig& rig, std::uint64_t seed, double duration_s) {
  RoomFlightOptions options;
  options.seed = seed;
  options.duration_s = duration_s;
  options.camera_rate_hz = 10;
  options.tracks = 40;
  return {rig, options};
}

TEST(CalibrationHintStatistics, FindsTheOffset) {
  const SimulatedRig rig = simulatedRig("euroc");
  const VectorXd wrong = VectorXd::Constant(1, 0.005);
  const auto hint = hintOf(flightOf(rig, 1, 9), changed(rig.calibration, wrong), HintKind::kOffset);
  ASSERT_TRUE(hint.has_value());
  EXPECT_LT(hint->std[0], 0.6e-3);
  EXPECT_GT(hint->std[0], 1e-5);
  EXPECT_LT(std::abs(hint->change[0] + wrong[0]), 4 * hint->std[0] + 0.1e-3);
}

TEST(CalibrationHintStatistics, FindsOffsetAndExtrinsics) {
  const SimulatedRig rig = simulatedRig("euroc");
  VectorXd wrong(7), floors(7);
  wrong << 2e-3, 0.01, -0.01, 0.01, 0.3 * kDegree, -0.3 * kDegree, 0.3 * kDegree;
  floors << 0.1e-3, 1e-3, 1e-3, 1e-3, 0.03 * kDegree, 0.03 * kDegree, 0.03 * kDegree;
  const auto hint =
      hintOf(flightOf(rig, 2, 9), changed(rig.calibration, wrong), HintKind::kExtrinsics);
  ASSERT_TRUE(hint.has_value());
  for (Eigen::Index i = 0; i < 7; ++i) {
    EXPECT_LT(std::abs(hint->change[i] + wrong[i]), 4 * hint->std[i] + floors[i]) << i;
    EXPECT_LT(hint->std[i], std::abs(wrong[i])) << i;
    EXPECT_GT(hint->std[i], 0) << i;
  }
}

}  // namespace
}  // namespace plumbline
