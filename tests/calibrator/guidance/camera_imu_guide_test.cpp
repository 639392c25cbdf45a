// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU stage on simulated recordings: its end and its decisions. Bad input has a file of
// its own (camera_imu_guide_input_test.cpp), and so has what it asks for when
// (camera_imu_guide_rounds_statistics_test.cpp). The trajectories' scores and the window have tests
// of their own.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "tests/calibrator/guidance/imu_guide_flight.h"

namespace plumbline {
namespace {

using test::imu_flight::countIn;
using test::imu_flight::endless;
using test::imu_flight::imuFrames;
using test::imu_flight::imuGuideRecording;
using test::imu_flight::ImuReplay;
using test::imu_flight::imuReplayed;
using test::imu_flight::kImuGuideSigma;

/// Shared: to its end by the threshold.
const ImuReplay& finishedReplay() {
  static const ImuReplay r = imuReplayed(imuFrames());
  return r;
}

/// chi-square of T_SC0's error under the batch's own covariance, 6 degrees of freedom.
double squaredError(const Result<CameraImuStageResult>& result) {
  const Vector6d error = boxminus(imuGuideRecording().truth.imu->T_SC0, result->imu.T_SC0);
  const Eigen::MatrixXd covariance = result->summary.covariance.matrix.topLeftCorner(6, 6);
  return error.dot(covariance.llt().solve(error));
}
constexpr double kChi2_999 = 22.46;  // 6 degrees of freedom, 99.9 %

TEST(CameraImuGuide, FinishesWithAnExtrinsicCalibrationWithinItsCovariance) {
  const ImuReplay& r = finishedReplay();
  ASSERT_TRUE(r.guide.finished());
  const auto result = r.guide.batch();
  ASSERT_TRUE(result) << result.failure();
  EXPECT_LT(squaredError(result), kChi2_999);
  EXPECT_LT(std::abs(result->imu.timeOffset() - imuGuideRecording().truth.imu->timeOffset()),
            4 * *result->imu.time_offset_std_s);
  EXPECT_LT(result->frames.size(), 120u);  // of those kept before the end, not of all 160
}

TEST(CameraImuGuide, LogsWhatDroveItsDecisions) {
  const ImuReplay& r = finishedReplay();
  EXPECT_EQ(countIn(r.decisions, GuideReason::kInitialised), 1);
  std::optional<double> entropy;
  bool finished = false;
  for (const Decision& d : r.decisions) {
    EXPECT_EQ(d.stage, GuideStage::kCameraImu);
    EXPECT_EQ(d.threshold_nats, 1.2);
    EXPECT_EQ(d.reason == GuideReason::kFinished, finished);
    finished = d.mode == GuideMode::kFinished;
    if (d.reason != GuideReason::kUsed) continue;
    EXPECT_TRUE(d.accepted && d.T_FC0 && d.rmse_px && d.entropy_nats && d.mi_nats);
    EXPECT_LT(*d.rmse_px, 3 * kImuGuideSigma);
    EXPECT_GT(*d.mi_nats, -0.05);  // knowledge grows, but for the estimate moving
    if (entropy) {
      EXPECT_NEAR(*entropy - *d.entropy_nats, *d.mi_nats, 1e-12);
    }
    entropy = d.entropy_nats;
  }
  const auto last = std::find_if(r.decisions.begin(), r.decisions.end(),
                                 [](const Decision& d) { return d.mode == GuideMode::kFinished; });
  ASSERT_NE(last, r.decisions.end());
  ASSERT_TRUE(last->round);
  EXPECT_LT(last->round->mi_nats[static_cast<std::size_t>(last->round->best)], 1.2);
  EXPECT_EQ(last->round->names.size(), 6u);
}

TEST(CameraImuGuide, FramesThatComeWhileItIsBusyAreDroppedButTheirSamplesAreNot) {
  GuideOptions options = endless();
  options.latency.imu_frame_s = 0.06;  // more than a frame's interval, less than two
  const ImuReplay r = imuReplayed(imuFrames(), options);
  EXPECT_EQ(countIn(r.decisions, GuideReason::kBusy), 80);
  EXPECT_EQ(countIn(r.decisions, GuideReason::kImuGap), 0);
  EXPECT_GT(countIn(r.decisions, GuideReason::kUsed), 30);
  for (const Decision& d : r.decisions) {
    if (d.reason != GuideReason::kBusy) continue;
    EXPECT_FALSE(d.accepted || d.entropy_nats || d.round);
  }
}

TEST(CameraImuGuide, ASuggestionIsOpenedReachedAndLeftAloneForItsDuration) {
  GuideOptions options = endless();
  options.trajectories.reached_px = 1e6;  // wherever the camera is
  options.trajectories.duration_s = 4;
  options.trajectories.max_speed_m_s = 5;
  CameraImuGuide guide(test::rigOf(imuGuideRecording()), imuGuideRecording().truth.cameras, options,
                       {.first_suggestion = 7});
  const auto decisions = test::replay(guide, imuFrames());
  std::optional<TimeNs> opened;
  std::optional<TimeNs> reached;
  int next = 7;
  for (const Decision& d : decisions) {
    if (d.event == SuggestionEvent::kOpened) {
      ASSERT_TRUE(d.opened);
      EXPECT_EQ(d.opened->id, next++);
      EXPECT_EQ(d.opened->path.size(), 60u);
      EXPECT_LT(boxminus(d.opened->path.front(), d.opened->T_FC0).norm(), 1e-12);
      EXPECT_EQ(d.opened->duration_s, 4);
      EXPECT_EQ(d.mode, GuideMode::kSuggesting);
      if (reached) {
        EXPECT_GE(d.t - *reached, 4'000'000'000);
        EXPECT_LE(d.t - *reached, 4'100'000'000) << "not the evaluator's next interval";
      }
      if (!opened) opened = d.t;
    }
    if (d.event == SuggestionEvent::kReached && !reached) {
      EXPECT_GE(d.held_s, 1);
      EXPECT_GE(d.t - *opened, 1'000'000'000);
      EXPECT_LE(d.t - *opened, 1'200'000'000);
      reached = d.t;
    }
  }
  EXPECT_TRUE(reached);
  EXPECT_EQ(guide.nextSuggestion(), next);
  EXPECT_EQ(next, 9);  // one after the start, one four seconds after it was reached
}

TEST(CameraImuGuide, ASuggestionThatIsOpenAtTheEndIsWithdrawn) {
  GuideOptions options = endless();
  options.trajectories.threshold_nats = 1.2;
  options.trajectories.reached_px = 0.1;
  const ImuReplay r = imuReplayed(imuFrames(), options);
  const auto last = std::find_if(r.decisions.begin(), r.decisions.end(),
                                 [](const Decision& d) { return d.mode == GuideMode::kFinished; });
  ASSERT_NE(last, r.decisions.end());
  ASSERT_NE(last, r.decisions.begin());
  ASSERT_EQ((last - 1)->mode, GuideMode::kSuggesting);
  EXPECT_EQ(last->event, SuggestionEvent::kWithdrawn);
  EXPECT_EQ(last->suggestion, (last - 1)->suggestion);
  EXPECT_FALSE((last + 1)->suggestion);
}

}  // namespace
}  // namespace plumbline
