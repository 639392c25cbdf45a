// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/offset_hint.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/simulate/random_stream.h"
#include "tests/calibrator/odometry/room_flight.h"

namespace plumbline {
namespace {

std::vector<FrameInnovation> innovationsOf(const RoomFlight& flight, Calibration calibration,
                                           double change_s) {
  calibration.imu->time_offsets[0].s += change_s;
  Odometry odometry(RigModel::of(calibration), flight.samples);
  for (const FrameTracks& frame : flight.frames) odometry.step(frame);
  return odometry.result().innovations;
}

// Flights that turn fast: an offset wrong by 5 ms is found, within four of its deviations, which
// are fractions of a millisecond.
TEST(OffsetHint, FindsTheOffsetOfSimulatedFlights) {
  const SimulatedRig rig = simulatedRig("euroc");
  for (const std::uint64_t seed : {1, 2}) {
    RoomFlightOptions options;
    options.seed = seed;
    options.duration_s = 12;
    const RoomFlight flight(rig, options);
    Calibration wrong = rig.calibration;
    wrong.imu->time_offsets[0].s += 0.005;
    const auto hint =
        offsetHint([&](double change_s) { return innovationsOf(flight, wrong, change_s); });
    ASSERT_TRUE(hint.has_value()) << seed;
    EXPECT_LT(hint->std_s, 0.6e-3) << seed;
    EXPECT_GT(hint->std_s, 1e-5) << seed;
    EXPECT_LT(std::abs(hint->change_s + 0.005), 4 * hint->std_s + 0.1e-3) << seed;
  }
}

std::vector<FrameInnovation> parabola(double change_s, double minimum_s, std::uint64_t seed) {
  std::vector<FrameInnovation> frames;
  RandomStream random(seed, RandomPurpose::kTracks);
  for (int k = 0; k < 400; ++k) {
    // The frame's own minimum scatters by 2 ms.
    const double x = (change_s - minimum_s - 2e-3 * random.normal()) / 1e-3;
    frames.push_back({50'000'000LL * k, 100 + 10 * x * x, 100});
  }
  return frames;
}

// Frames whose minima scatter by 2 ms: 400 of them say 0.1 ms, and so does the deviation.
TEST(OffsetHint, DeviationIsThatOfManyTrials) {
  double squares = 0, stated = 0;
  constexpr int kTrials = 200;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const auto hint = offsetHint([&](double change_s) { return parabola(change_s, -4e-3, seed); });
    ASSERT_TRUE(hint.has_value());
    squares += (hint->change_s + 4e-3) * (hint->change_s + 4e-3) / kTrials;
    stated += hint->std_s * hint->std_s / kTrials;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.1e-3, 0.02e-3);
  EXPECT_NEAR(std::sqrt(stated), 0.1e-3, 0.02e-3);
}

TEST(OffsetHint, NothingWithoutAMinimum) {
  EXPECT_FALSE(offsetHint([](double) { return std::vector<FrameInnovation>{}; }).has_value());
  EXPECT_FALSE(offsetHint([](double change_s) { return parabola(change_s, 0.05, 1); }).has_value());
}

}  // namespace
}  // namespace plumbline
