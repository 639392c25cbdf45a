// SPDX-License-Identifier: BSD-3-Clause
// The camera stage by predicted error.
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/corners.h"
#include "calibrator/guidance/frame_corners.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/views/view_error.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

using test::LiveRig;

constexpr double kSigma = 0.3;  // [px]

GuideOptions byError(LaterUseKind later_use = LaterUseKind::kImage) {
  GuideOptions options;
  options.views.pixel_sigma = kSigma;
  options.views.cauchy_px = 0;
  options.views.criterion = ViewCriterion::kPredictedError;
  options.views.later_use = later_use;
  return options;
}

/// Mean squared error per corner of exact frames of another part of the motion, their poses free.
double trueSquaredError(const LiveRig& rig, const std::vector<CameraCalibration>& cameras) {
  const LiveRig exact("euroc", 5, 0);
  const CameraEstimate estimate = estimateOf(cameras);
  const AprilGrid target = rig.guideRig().target;
  double squares = 0;
  int corners = 0;
  for (int i = 0; i < 60; ++i) {
    const auto frame = usableViews(exact.frame(i, i, exact.wandering(200 + 0.7 * i)), 2, 16);
    const auto T_FC0 = poseOf(target, estimate, frame, 0);
    if (!T_FC0) continue;
    for (std::size_t c = 0; c < frame.size(); ++c) {
      if (frame[c].empty()) continue;
      const PackedCorners packed(target, {{0, frame[c]}});
      const Transform T_CF = estimate.T_C0Ci[c].inverse() * T_FC0->inverse();
      squares += viewCost(estimate.intrinsics[c], T_CF, packed.view(0));
      corners += static_cast<int>(frame[c].size());
    }
  }
  return squares / corners;
}

TEST(CameraGuideByError, StopsWithFewViewsAndSaysHowGoodTheyAre) {
  const LiveRig rig("euroc", 5, kSigma);
  for (const auto later_use : {LaterUseKind::kSeen, LaterUseKind::kImage}) {
    CameraGuide guide(rig.guideRig(), byError(later_use));
    const auto decisions = test::playGuided(guide, rig, 1500);
    ASSERT_TRUE(guide.finished()) << toString(later_use);
    const Decision& last = decisions.back();
    EXPECT_GE(last.views_kept, 8);
    // Where only frames seen count, it goes on until they cover the images.
    EXPECT_LE(last.views_kept, later_use == LaterUseKind::kSeen ? 35 : 30);
    ASSERT_TRUE(last.excess && last.error_px);
    EXPECT_LE(*last.excess, 0.02);
    const auto batch = guide.batch();
    ASSERT_TRUE(batch.ok()) << batch.failure();
    const double truth = trueSquaredError(rig, batch->cameras);
    // 22 parameters' errors where the motion goes, of a prediction for another distribution.
    EXPECT_LT(truth, 8 * *last.error_px * *last.error_px) << toString(later_use);
    EXPECT_LT(std::sqrt(1 + truth / (2 * kSigma * kSigma)) - 1, 0.06) << toString(later_use);
  }
}

// What was seen of one part of the image says nothing of later use in the rest of it.
TEST(CameraGuideByError, DoesNotStopWhereTheFramesSoFarCoverLittleOfTheImage) {
  const LiveRig rig("euroc", 5, kSigma);
  const auto keepLeft = [](GuideFrame& frame) {
    for (auto& camera : frame.corners) {
      std::erase_if(camera, [](const Corner& c) { return c.uv.x() > 376; });
    }
  };
  CameraGuide guide(rig.guideRig(), byError(LaterUseKind::kSeen));
  const auto decisions = test::playWandering(guide, rig, 400, 10, keepLeft);
  EXPECT_FALSE(guide.finished());
  int told = 0, small = 0;
  for (const Decision& d : decisions) {
    small += d.views_kept >= 8 && d.excess && *d.excess <= 0.02 ? 1 : 0;
    told += d.detail.find("no stop before 90 %") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(small, 50) << "the predicted error alone would have stopped it";
  EXPECT_EQ(told, 1);
}

TEST(CameraGuideByError, AViewIsKeptWhereItLowersTheErrorEnough) {
  const LiveRig rig("euroc", 6, kSigma);
  GuideOptions options = byError();
  options.views.stop_excess = 1e-6;
  CameraGuide guide(rig.guideRig(), options);
  int kept = 0, passed = 0;
  for (const Decision& d : test::playWandering(guide, rig, 200, 10)) {
    if (!d.error_bound_px) continue;
    ASSERT_TRUE(d.error_with_px);
    if (d.reason == GuideReason::kBadFit) continue;
    EXPECT_EQ(d.accepted, *d.error_with_px <= *d.error_bound_px);
    EXPECT_EQ(d.reason, d.accepted ? GuideReason::kInformative : GuideReason::kNotInformative);
    ++(d.accepted ? kept : passed);
  }
  EXPECT_GT(kept, 5);
  EXPECT_GT(passed, 50);
}

TEST(CameraGuideByError, AFrameOfSeveralPixelsDoesNotEnter) {
  const LiveRig rig("euroc", 7, kSigma);
  GuideOptions options = byError();
  options.views.stop_excess = 1e-6;
  CameraGuide guide(rig.guideRig(), options);
  const auto decisions = test::playWandering(guide, rig, 150, 10, [](GuideFrame& frame) {
    if (frame.index < 60 || frame.index % 5 != 0) return;
    for (auto& camera : frame.corners) {
      for (std::size_t i = 0; i < camera.size(); ++i) {
        camera[i].uv += Eigen::Vector2d(i % 2 == 0 ? 3 : -3, i % 3 == 0 ? 3 : -1.5);
      }
    }
  });
  for (const Decision& d : decisions) {
    if (d.frame >= 60 && d.frame % 5 == 0) {
      EXPECT_FALSE(d.accepted) << d.frame;
    }
  }
  EXPECT_GT(test::countOf(decisions, GuideReason::kBadFit), 0);
}

// To the last bit, whatever its solution did to the cameras.
TEST(CameraGuideByError, AFrameThatDoesNotFitLeavesNothingBehind) {
  const LiveRig rig("euroc", 7, kSigma);
  GuideOptions options = byError();
  options.views.stop_excess = 1e-6;
  options.views.min_views = 1000;
  options.views.least_lowering = 1e-3;  // nearly every view is worth keeping
  const auto played = [&](bool seen) {
    CameraGuide guide(rig.guideRig(), options);
    return test::playWandering(guide, rig, 80, 10, [&](GuideFrame& frame) {
      if (frame.index < 60 || frame.index % 5 != 0) return;
      for (auto& camera : frame.corners) {
        if (!seen) camera.clear();
        for (std::size_t i = 0; i < camera.size(); ++i) {
          camera[i].uv += Eigen::Vector2d(i % 2 == 0 ? 3 : -3, i % 3 == 0 ? 3 : -1.5);
        }
      }
    });
  };
  const auto with = played(true), without = played(false);
  // The first view that was kept after a frame that did not fit.
  std::size_t k = 0;
  while (k < with.size() && with[k].reason != GuideReason::kBadFit) ++k;
  while (k < with.size() && !with[k].accepted) ++k;
  ASSERT_LT(k, with.size());
  EXPECT_TRUE(without[k].accepted);
  EXPECT_EQ(with[k].entropy_nats, without[k].entropy_nats);
  EXPECT_EQ(with[k].rmse_px, without[k].rmse_px);
}

TEST(CameraGuideByError, ViewsWithoutNoiseFit) {
  const LiveRig rig("euroc", 7, 0);
  GuideOptions options = byError();
  options.views.stop_excess = 1e-6;
  CameraGuide guide(rig.guideRig(), options);
  const auto decisions = test::playWandering(guide, rig, 100, 10);
  EXPECT_GT(test::countOf(decisions, GuideReason::kInformative), 0);
  EXPECT_EQ(test::countOf(decisions, GuideReason::kBadFit), 0);
}

TEST(CameraGuideByError, SuggestsTheCandidateThatLeavesLeast) {
  const LiveRig rig("euroc", 8, kSigma);
  GuideOptions options = byError(LaterUseKind::kImage);
  options.views.stop_excess = 1e-6;
  CameraGuide guide(rig.guideRig(), options);
  int rounds = 0;
  for (const Decision& d : test::playGuided(guide, rig, 300)) {
    if (!d.opened || !d.round || d.round->error_px.empty()) continue;
    ++rounds;
    ASSERT_EQ(d.round->error_px.size(), d.round->names.size());
    EXPECT_EQ(*d.opened->error_px, d.round->error_px[static_cast<std::size_t>(d.round->best)]);
    // Of candidates that differ by rounding only, the first is suggested.
    const double least = (1 - 1e-6) * *d.opened->error_px;
    for (const double px : d.round->error_px) EXPECT_FALSE(px < least);
    EXPECT_LT(*d.opened->error_px, *d.error_px);
  }
  EXPECT_GE(rounds, 2);
}

TEST(CameraGuideByError, DecidesTheSameWithAnyNumberOfThreads) {
  const LiveRig rig("euroc", 9, kSigma);
  GuideOptions options = byError(LaterUseKind::kImage);
  options.views.stop_excess = 0.001;
  CameraGuide one(rig.guideRig(), options);
  options.threads = 3;
  CameraGuide three(rig.guideRig(), options);
  EXPECT_EQ(test::textOf(test::playGuided(one, rig, 120)),
            test::textOf(test::playGuided(three, rig, 120)));
}

TEST(ViewErrorTracker, ImaginedAndSeenViewsOfOnePlaceAreWorthTheSame) {
  const LiveRig exact("euroc", 3, 0);
  ViewErrorOptions options;
  options.cauchy_px = 0;
  options.later_use = LaterUseKind::kSeen;
  ViewErrorTracker errors(exact.guideRig().target, options);
  for (int i = 0; i < 10; ++i) {
    const Transform T_FC0 = exact.wandering(0.7 * i);
    const auto corners = usableViews(exact.frame(i, 0.7 * i, T_FC0), 2, 16);
    errors.see(corners, T_FC0);
    errors.keep(corners, T_FC0);
  }
  errors.refresh(estimateOf(exact.truth()), exact.truth(), 1);
  ASSERT_TRUE(errors.isKnown());
  for (const double t : {9.0, 11.0, 14.0}) {
    const Transform T_FC0 = exact.wandering(t);
    const auto corners = usableViews(exact.frame(99, t, T_FC0), 2, 16);
    const double imagined = errors.predictedWith({T_FC0}, 1).front();
    EXPECT_NEAR(errors.seenWith(corners, T_FC0) / imagined, 1, 1e-6);
  }
}

}  // namespace
}  // namespace plumbline
