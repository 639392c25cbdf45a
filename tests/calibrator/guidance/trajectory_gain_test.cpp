// SPDX-License-Identifier: BSD-3-Clause
// Predicted gains of trajectories, against the information of one problem that holds the recording
// and the trajectory. Whether they come true is for trajectory_gain_statistics_test.
#include "calibrator/guidance/trajectory_gain.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/information/covariance.h"
#include "tests/calibrator/guidance/recorded_trajectory.h"

namespace plumbline {
namespace {

const testing::WindowRecording& recording() {
  static const testing::WindowRecording r = [] {
    SimulationOptions options;
    options.duration_s = 2;
    options.corner_sigma_px = 0.2;
    return testing::recordingOf(options, 0.2);
  }();
  return r;
}

/// A window that has seen all frames, at the truth.
WindowKnowledge knowledgeAtTheTruth() {
  const testing::WindowRecording& r = recording();
  const auto weights = imuWeights(r.problem, r.truth);
  const auto normals = informationAt(r.problem, r.truth, *weights);
  const auto end = frontEliminated(normals->chain, r.problem.frameCount() - 1);
  WindowKnowledge now{end->H, r.truth, r.problem.frames.back().t};
  now.estimate.states = {r.truth.states.back()};
  return now;
}

std::vector<LissajousTrajectory> six() {
  return lissajousTrajectories(lissajousShapes(), AprilGrid{}, recording().truth.T_SC0, {});
}

TrajectoryScorer scorer(const TrajectoryRecording& planned) {
  return {planned, six(), recording().truth.cameras};
}

TEST(TrajectoryGain, IsTheInformationThatOneProblemWithTheTrajectoryHasMore) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  testing::RecordedTrajectoryOptions how;
  for (const bool offset : {false, true}) {
    TrajectoryRecording planned = testing::plannedRecording(recording(), how);
    planned.score_offset = offset;
    const auto gains = scorer(planned).gainsNats(now);
    const auto before = calibrationInformation(now.information, offset);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      const auto joint = testing::jointProblem(
          recording(), testing::recordAlong(six()[i], recording(), now.t, how));
      const auto after = testing::batchInformation(joint.problem, joint.truth, offset);
      EXPECT_GT(gains[i], 0.3) << i;
      EXPECT_NEAR(gains[i], *mutualInformationNats(*before, after), 2e-3 * gains[i]) << i;
    }
  }
}

TEST(TrajectoryGain, DoesNotDependOnTheNumberOfThreads) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  const TrajectoryScorer s = scorer(testing::plannedRecording(recording(), {}));
  const auto one = s.gainsNats(now, 1);
  EXPECT_EQ(one, s.gainsNats(now, 2));
  EXPECT_EQ(one, s.gainsNats(now, 5));
}

TEST(TrajectoryGain, FallsAsMoreIsKnown) {
  WindowKnowledge now = knowledgeAtTheTruth();
  const TrajectoryScorer s = scorer(testing::plannedRecording(recording(), {}));
  const auto first = s.gainsNats(now);
  now.information *= 10;
  const auto later = s.gainsNats(now);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_LT(later[i], 0.6 * first[i]);
    EXPECT_GT(later[i], 0);
  }
}

TEST(TrajectoryGain, FallsWithTheNoiseOfCornersAndImu) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  TrajectoryRecording planned = testing::plannedRecording(recording(), {});
  const auto first = scorer(planned).gainsNats(now);
  TrajectoryRecording pixels = planned;
  pixels.pixel_sigma *= 3;
  TrajectoryRecording imu = planned;
  imu.noise.accel_density *= 5;
  imu.noise.gyro_density *= 5;
  const auto with_pixels = scorer(pixels).gainsNats(now);
  const auto with_imu = scorer(imu).gainsNats(now);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_LT(with_pixels[i], 0.9 * first[i]);
    EXPECT_LT(with_imu[i], 0.9 * first[i]);
  }
}

// A camera that sees nothing, or a present that leaves something free, gives no score rather than
// one of zero.
TEST(TrajectoryGain, WithoutCornersOrKnowledgeThereIsNoScore) {
  WindowKnowledge now = knowledgeAtTheTruth();
  TrajectoryRecording blind = testing::plannedRecording(recording(), {});
  blind.min_corners = 1000;
  for (const double gain : scorer(blind).gainsNats(now)) EXPECT_TRUE(std::isnan(gain));
  now.information.setZero();
  const auto gains = scorer(testing::plannedRecording(recording(), {})).gainsNats(now);
  EXPECT_EQ(gains.size(), 6u);
  for (const double gain : gains) EXPECT_TRUE(std::isnan(gain));
}

}  // namespace
}  // namespace plumbline
