// SPDX-License-Identifier: BSD-3-Clause
// What a motion-capture system delivers: poses by its own clock and worlds, stamps, gaps, columns.
#include "evaluate/simulation/motion_capture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "evaluate/simulation/simulate_sequence.h"
#include "tests/calibrator/base/option_refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

SimulatedSession recordedFor(double duration_s) {
  SimulationOptions simulation;
  simulation.duration_s = duration_s;
  return simulateSession(simulatedRig("euroc"), simulation);
}

// Back through the marker body, the worlds and the clock the poses are the rig's, but for noise.
TEST(MotionCapture, SeesTheMarkerBodyByItsOwnClock) {
  SimulationOptions simulation;
  simulation.duration_s = 8;
  const SimulatedSession session = simulateSession(simulatedRig("d435i"), simulation);
  const MotionCaptureOptions o;
  const MotionCapture capture = simulateMotionCapture(session, o);
  ASSERT_EQ(capture.gaps_s.size(), 2U);
  double squares = 0;
  for (const StampedPose& pose : capture.trajectory.poses) {
    const TimeNs t_imu = pose.t + toNanoseconds(o.clock_offset_s);
    const double t_s = secondsBetween(session.start_ns, t_imu);
    for (const auto& [begin, end] : capture.gaps_s) EXPECT_FALSE(t_s >= begin && t_s < end - 1e-9);
    const Transform T_WS = o.T_VW.inverse() * pose.transform() * o.T_SM.inverse();
    const Transform truth = session.T_WF() * session.motionAtImuTime(t_imu).T_FB;
    squares += (T_WS.t - truth.t).squaredNorm();
    EXPECT_LT(rotationAngle(T_WS.R.transpose() * truth.R), 6 * o.noise_rad);
  }
  const auto n = static_cast<double>(capture.trajectory.poses.size());
  EXPECT_GT(n, 600);
  // The marker body is 0.1 m from the IMU: its orientation's noise adds a little.
  EXPECT_NEAR(std::sqrt(squares / n / 3), o.noise_m, 0.3 * o.noise_m);
}

TEST(MotionCapture, CoversAllFramesAtItsOwnRate) {
  const SimulatedSession session = recordedFor(4);
  MotionCaptureOptions o;
  o.rate_hz = 40;
  o.drop_outs = 0;
  o.clock_offset_s = 12.5;
  const auto poses = simulateMotionCapture(session, o).trajectory.poses;
  const TimeNs offset = toNanoseconds(o.clock_offset_s);
  EXPECT_EQ(poses.front().t, session.start_ns - offset) << "t_imu = t_mocap + clock_offset_s";
  for (std::size_t i = 1; i < poses.size(); ++i) {
    EXPECT_NEAR(secondsBetween(poses[i - 1].t, poses[i].t), 1 / o.rate_hz, 2e-9);
  }
  const double span = secondsBetween(session.frame_stamps.front(), session.frame_stamps.back());
  const double covered = secondsBetween(poses.front().t, poses.back().t);
  EXPECT_GE(covered, span - 1e-9);
  EXPECT_LT(covered, span + 1 / o.rate_hz);
}

// A study of gaps compares the same poses with and without them.
TEST(MotionCapture, GapsTakePosesAwayAndChangeNoOther) {
  const SimulatedSession session = recordedFor(6);
  MotionCaptureOptions o;
  o.drop_outs = 0;
  const auto whole = simulateMotionCapture(session, o).trajectory.poses;
  o.drop_outs = 3;
  o.drop_out_s = 0.4;
  const MotionCapture with_gaps = simulateMotionCapture(session, o);
  ASSERT_EQ(with_gaps.gaps_s.size(), 3U);
  const double span = secondsBetween(session.frame_stamps.front(), session.frame_stamps.back());
  std::vector<StampedPose> expected;
  for (const StampedPose& pose : whole) {
    const double t_s = secondsBetween(whole.front().t, pose.t);
    const bool lost = std::any_of(
        with_gaps.gaps_s.begin(), with_gaps.gaps_s.end(),
        [&](const auto& gap) { return t_s > gap.first - 1e-6 && t_s < gap.second - 1e-6; });
    if (!lost) expected.push_back(pose);
  }
  const auto& left = with_gaps.trajectory.poses;
  ASSERT_EQ(left.size(), expected.size());
  EXPECT_LT(left.size(), whole.size() - 30) << "one gap at least, whether they overlap or not";
  for (std::size_t i = 0; i < left.size(); ++i) {
    EXPECT_EQ(left[i].t, expected[i].t);
    EXPECT_EQ(left[i].p, expected[i].p);
  }
  for (const auto& [begin, end] : with_gaps.gaps_s) {
    EXPECT_NEAR(end - begin, 0.4, 1e-12);
    EXPECT_GT(begin, 0);
    EXPECT_LT(end, span);
  }
  // Of a recording of a second a gap takes a tenth at most.
  for (const auto& [begin, end] : simulateMotionCapture(recordedFor(1), o).gaps_s) {
    EXPECT_LT(end - begin, 0.11);
  }
}

TEST(MotionCapture, IsWrittenInEurocsColumns) {
  const TemporaryFolder folder;
  const SimulatedSession session = recordedFor(1);
  const MotionCaptureOptions o;
  writeMotionCapture(session, o, folder.path(), "seq");
  std::ifstream file(folder.path("seq/mav0/mocap0/data.csv"));
  std::string header, row;
  ASSERT_TRUE(std::getline(file, header) && std::getline(file, row));
  EXPECT_EQ(header, "#timestamp [ns], p_x [m], p_y [m], p_z [m], q_w [], q_x [], q_y [], q_z []");
  const StampedPose first = simulateMotionCapture(session, o).trajectory.poses.front();
  const Eigen::Quaterniond& q = first.q;
  EXPECT_EQ(row, fmt::format("{},{:.9g},{:.9g},{:.9g},{:.12g},{:.12g},{:.12g},{:.12g}", first.t,
                             first.p.x(), first.p.y(), first.p.z(), q.w(), q.x(), q.y(), q.z()));
}

TEST(MotionCapture, ItsTruthIsToldBesideIt) {
  const TemporaryFolder folder;
  const SimulatedSession session = recordedFor(2);
  MotionCaptureOptions o;
  o.drop_outs = 1;
  o.clock_offset_s = -0.25;
  const Json truth = writeMotionCapture(session, o, folder.path(), "sequences/seq01");
  EXPECT_EQ(truth.at("clock_offset_s"), -0.25);
  const auto gap = simulateMotionCapture(session, o).gaps_s.front();
  EXPECT_EQ(truth.at("gaps_s").at(0).at(0), gap.first);
  EXPECT_EQ(truth.at("gaps_s").at(0).at(1), gap.second);
  EXPECT_TRUE(std::filesystem::exists(folder.path("sequences/seq01/mav0/mocap0/data.csv")));
}

// The first rest is the one before the flight, where there is one.
TEST(RestsInFlight, AreThoseAfterTheFirst) {
  const SimulatedFlight flight{recordedFor(1), {{-10, 2}, {8, 9}, {15, 16}}, 0, {}, {}, 0};
  FlightOptions options;
  options.first_rest_s = 2;
  EXPECT_EQ(restsInFlight(options, flight), 2);
  options.first_rest_s = 0;
  EXPECT_EQ(restsInFlight(options, flight), 3);
}

TEST(SequenceOptions, NameWhatIsOutOfRange) {
  using test::refusalOf;
  EXPECT_EQ(refusalOf<SequenceOptions>([](auto&) {}), "");
  EXPECT_THAT(refusalOf<SequenceOptions>([](auto& o) { o.images.exposure_s = 2; }),
              HasSubstr("images.exposure_s"));
  EXPECT_THAT(refusalOf<SequenceOptions>([](auto& o) { o.images.noise_sigma = -1; }),
              HasSubstr("images.noise_sigma"));
  EXPECT_THAT(refusalOf<SequenceOptions>([](auto& o) { o.motion_capture.rate_hz = 0; }),
              HasSubstr("rate_hz"));
  EXPECT_THAT(refusalOf<SequenceOptions>([](auto& o) { o.motion_capture.noise_m = 2; }),
              HasSubstr("noise_m"));
  EXPECT_THAT(refusalOf<SequenceOptions>([](auto& o) { o.motion_capture.drop_outs = -1; }),
              HasSubstr("drop_outs"));
}

}  // namespace
}  // namespace plumbline
