// SPDX-License-Identifier: BSD-3-Clause
// Predicted gains of trajectories, against the information of one problem that holds the recording
// and the trajectory. Whether they come true is for trajectory_gain_statistics_test.
#include "calibrator/guidance/trajectories/trajectory_gain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/information/covariance.h"
#include "tests/calibrator/guidance/recorded_trajectory.h"

namespace plumbline {
namespace {

const test::WindowRecording& shortWindow() {
  static const test::WindowRecording r = [] {
    SimulationOptions options;
    options.duration_s = 2;
    options.corner_sigma_px = 0.2;
    return test::recordingOf(options, 0.2);
  }();
  return r;
}

/// A window that has seen all frames, at the truth.
WindowKnowledge knowledgeAtTheTruth() {
  const test::WindowRecording& r = shortWindow();
  const auto weights = imuWeights(r.problem, r.truth);
  const auto normals = informationAt(r.problem, r.truth, *weights);
  const auto end = frontEliminated(normals->chain, cameraInformationAt(r.problem, r.truth).chain,
                                   r.problem.frameCount() - 1);
  WindowKnowledge now{end->H, r.truth, r.problem.frames.back().t, end->noise};
  now.estimate.states = {r.truth.states.back()};
  return now;
}

std::vector<LissajousTrajectory> six() {
  return lissajousTrajectories(lissajousShapes(), AprilGrid{}, shortWindow().truth.T_SC0, {});
}

TrajectoryScorer scorer(const TrajectoryRecording& planned) {
  return {planned, six(), shortWindow().truth.cameras};
}

TEST(TrajectoryGain, IsTheInformationThatOneProblemWithTheTrajectoryHasMore) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  test::RecordedTrajectoryOptions how;
  for (const bool offset : {false, true}) {
    TrajectoryRecording planned = test::plannedRecording(shortWindow(), how);
    planned.score_offset = offset;
    const auto gains = scorer(planned).scores(now).gain_nats;
    const auto before = calibrationInformation(now.information, offset);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      const auto joint =
          test::jointProblem(shortWindow(), test::recordAlong(six()[i], shortWindow(), now.t, how));
      const auto after = test::batchInformation(joint.problem, joint.truth, offset);
      EXPECT_GT(gains[i], 0.3) << i;
      EXPECT_NEAR(gains[i], *mutualInformationNats(*before, after), 2e-3 * gains[i]) << i;
    }
  }
}

TEST(TrajectoryGain, PredictedErrorIsThatOfOneProblemWithTheTrajectory) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  const test::RecordedTrajectoryOptions how;
  const auto scores = scorer(test::plannedRecording(shortWindow(), how)).scores(now);
  const ImuReprojection reprojection(shortWindow().truth.cameras);
  const double before = *scorer(test::plannedRecording(shortWindow(), how)).squaredPx(now);
  for (std::size_t i = 0; i < scores.squared_px.size(); ++i) {
    const auto joint =
        test::jointProblem(shortWindow(), test::recordAlong(six()[i], shortWindow(), now.t, how));
    const auto after = test::batchInformation(joint.problem, joint.truth, true);
    const double E = *reprojection.expectedError(after, joint.truth.T_SC0);
    EXPECT_NEAR(scores.squared_px[i], E, 5e-3 * E) << i;
    EXPECT_LT(scores.squared_px[i], 0.9 * before) << i;
  }
}

/// The round that an evaluator answers, by a criterion.
CandidateRound roundBy(ViewCriterion criterion, const WindowKnowledge& now) {
  EvaluatorTiming timing;
  timing.criterion = criterion;
  TrajectoryEvaluator evaluator(scorer(test::plannedRecording(shortWindow(), {})), timing);
  evaluator.ask(now.t, now, 4);
  return *evaluator.answerAt(now.t);
}

TEST(TrajectoryGain, AnAnswerThatIsWantedDoesNotWaitForTheInterval) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  EvaluatorTiming timing;
  timing.every_s = 1;
  timing.latency_s = 0.25;
  TrajectoryEvaluator evaluator(scorer(test::plannedRecording(shortWindow(), {})), timing);
  const auto after = [&](double s) { return now.t + toNanoseconds(s); };
  evaluator.ask(now.t, now);
  EXPECT_FALSE(evaluator.isDue(after(2))) << "not answered yet";
  ASSERT_TRUE(evaluator.answerAt(after(0.25)));
  evaluator.answerBy(after(0.75));
  EXPECT_FALSE(evaluator.isDue(after(0.45)));
  ASSERT_TRUE(evaluator.isDue(after(0.5)));
  evaluator.ask(after(0.5), now);
  EXPECT_TRUE(evaluator.answerAt(after(0.75)));
  EXPECT_FALSE(evaluator.isDue(after(1.4))) << "wanted once";
  EXPECT_TRUE(evaluator.isDue(after(1.5)));
}

// One axis of T_SC0's translation is hardly known, and nearly every trajectory makes it known.
// Information counts by ratios: it takes the one that adds most to all the rest as well. In
// pixels the axis is all that is left, and the one that settles it best is asked for.
TEST(TrajectoryGain, CriteriaDisagreeWhereOneErrorIsMostOfTheShift) {
  WindowKnowledge now = knowledgeAtTheTruth();
  const int axis = kChainBlock + 1;
  now.information.row(axis) *= 0.01;
  now.information.col(axis) *= 0.01;
  const CandidateRound gain = roundBy(ViewCriterion::kMutualInformation, now);
  const CandidateRound error = roundBy(ViewCriterion::kPredictedError, now);
  EXPECT_EQ(gain.error_px, error.error_px);
  EXPECT_NE(gain.best, error.best);
  const auto at = [](const std::vector<double>& scores, int i) {
    return scores[static_cast<std::size_t>(i)];
  };
  EXPECT_GT(at(gain.mi_nats, gain.best), at(gain.mi_nats, error.best));
  EXPECT_LT(at(gain.error_px, error.best), 0.98 * at(gain.error_px, gain.best));
  // Squared errors were scaled by 4.
  const auto scores = scorer(test::plannedRecording(shortWindow(), {})).scores(now);
  EXPECT_NEAR(error.error_px[0], 2 * std::sqrt(scores.squared_px[0]), 1e-12);
}

TEST(TrajectoryGain, DoesNotDependOnTheNumberOfThreads) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  const TrajectoryScorer s = scorer(test::plannedRecording(shortWindow(), {}));
  const auto one = s.scores(now, 1).gain_nats;
  EXPECT_EQ(one, s.scores(now, 2).gain_nats);
  EXPECT_EQ(one, s.scores(now, 5).gain_nats);
}

TEST(TrajectoryGain, FallsAsMoreIsKnown) {
  WindowKnowledge now = knowledgeAtTheTruth();
  const TrajectoryScorer s = scorer(test::plannedRecording(shortWindow(), {}));
  const auto first = s.scores(now).gain_nats;
  now.information *= 10;
  const auto later = s.scores(now).gain_nats;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_LT(later[i], 0.6 * first[i]);
    EXPECT_GT(later[i], 0);
  }
}

TEST(TrajectoryGain, FallsWithTheNoiseOfCornersAndImu) {
  const WindowKnowledge now = knowledgeAtTheTruth();
  TrajectoryRecording planned = test::plannedRecording(shortWindow(), {});
  const auto first = scorer(planned).scores(now).gain_nats;
  TrajectoryRecording pixels = planned;
  pixels.pixel_sigma *= 3;
  TrajectoryRecording imu = planned;
  imu.noise.accel_density *= 5;
  imu.noise.gyro_density *= 5;
  const auto with_pixels = scorer(pixels).scores(now).gain_nats;
  const auto with_imu = scorer(imu).scores(now).gain_nats;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_LT(with_pixels[i], 0.9 * first[i]);
    EXPECT_LT(with_imu[i], 0.9 * first[i]);
  }
}

// A camera that sees nothing, or a present that leaves something free, gives no score rather than
// one of zero.
TEST(TrajectoryGain, WithoutCornersOrKnowledgeThereIsNoScore) {
  WindowKnowledge now = knowledgeAtTheTruth();
  TrajectoryRecording blind = test::plannedRecording(shortWindow(), {});
  blind.min_corners = 1000;
  for (const double gain : scorer(blind).scores(now).gain_nats) EXPECT_TRUE(std::isnan(gain));
  now.information.setZero();
  const auto gains = scorer(test::plannedRecording(shortWindow(), {})).scores(now).gain_nats;
  EXPECT_EQ(gains.size(), 6u);
  for (const double gain : gains) EXPECT_TRUE(std::isnan(gain));
}

/// The fewest corners of any frame along a trajectory, in the camera that sees most.
int fewestCorners(const LissajousTrajectory& trajectory, double rate_hz) {
  int fewest = std::numeric_limits<int>::max();
  for (int k = 0; k <= static_cast<int>(trajectory.durationS() * rate_hz); ++k) {
    std::size_t most = 0;
    for (const CameraCalibration& camera : shortWindow().truth.cameras) {
      const Transform T_FC = trajectory.cameraAt(k / rate_hz).T_FB * camera.T_C0Ci;
      most = std::max(most, visibleCorners(camera.intrinsics, T_FC, {}).size());
    }
    fewest = std::min(fewest, static_cast<int>(most));
  }
  return fewest;
}

// Nobody can follow it: however much its other frames tell, it is not asked for.
TEST(TrajectoryGain, ATrajectoryThatLosesTheTargetHasNoScore) {
  TrajectoryRecording planned = test::plannedRecording(shortWindow(), {});
  std::vector<int> fewest;
  for (const auto& t : six()) fewest.push_back(fewestCorners(t, planned.camera_rate_hz));
  const auto [least, most] = std::minmax_element(fewest.begin(), fewest.end());
  ASSERT_LT(*least, *most);
  planned.min_corners = *most;
  const auto gains = scorer(planned).scores(knowledgeAtTheTruth()).gain_nats;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    EXPECT_EQ(std::isnan(gains[i]), fewest[i] < *most) << six()[i].name();
  }
}

TEST(TrajectoryGain, RefusesWhatNobodyRecords) {
  const TrajectoryRecording planned = test::plannedRecording(shortWindow(), {});
  for (double TrajectoryRecording::*field :
       {&TrajectoryRecording::camera_rate_hz, &TrajectoryRecording::imu_rate_hz,
        &TrajectoryRecording::gravity_m_s2, &TrajectoryRecording::pixel_sigma}) {
    TrajectoryRecording wrong = planned;
    wrong.*field = 0;
    EXPECT_THROW(scorer(wrong), InputError);
  }
  TrajectoryRecording wrong = planned;
  wrong.min_corners = 0;
  EXPECT_THROW(scorer(wrong), InputError);
}

}  // namespace
}  // namespace plumbline
