// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/evaluate_trajectory.h"

#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "evaluate/metrics/failure_text.h"
#include "evaluate/trajectory/remarks.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A spiral at 10 Hz from `start_s`, 20 s long.
Trajectory spiralFrom(double start_s) {
  Trajectory trajectory;
  for (int i = 0; i < 200; ++i) {
    const double a = 0.1 * i;
    trajectory.poses.push_back(
        {toNanoseconds(start_s) + 100'000'000LL * i,
         {2 * std::cos(a), 2 * std::sin(a), 0.1 * a},
         Eigen::Quaterniond(Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()))});
  }
  return trajectory;
}

// A hand's way, 20 s at 20 Hz, that turns about two axes.
Trajectory wayFrom(double start_s) {
  Trajectory way;
  for (int i = 0; i < 400; ++i) {
    const double a = 0.05 * i;
    const Eigen::AngleAxisd yaw(std::sin(0.8 * a) + 0.4 * std::sin(1.9 * a),
                                Eigen::Vector3d::UnitZ());
    const Eigen::AngleAxisd pitch(0.6 * std::sin(1.1 * a), Eigen::Vector3d::UnitY());
    way.poses.push_back(
        {toNanoseconds(start_s + a),
         {std::sin(0.9 * a) + 0.3 * std::sin(2.3 * a), std::cos(0.61 * a), 0.4 * std::sin(1.3 * a)},
         Eigen::Quaterniond(yaw * pitch)});
  }
  return way;
}

Failure refusal(const Trajectory& estimate, const Trajectory& truth) {
  const auto result = evaluateTrajectories(estimate, truth, {});
  EXPECT_FALSE(result.ok());
  return result.ok() ? Failure{} : result.failure();
}

TEST(EvaluateTrajectories, AnExactEstimateHasNoErrorAndNoRemarks) {
  TrajectoryMetricOptions options;
  options.rpe = {{1, RelativeDelta::Unit::kMetres}, {1, RelativeDelta::Unit::kFrames}};
  const auto result = evaluateTrajectories(spiralFrom(0), spiralFrom(0), options);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->association.matches, 200U);
  EXPECT_LT(result->ate_translation_m.rmse, 1e-12);
  EXPECT_LT(result->ate_rotation_deg.rmse, 1e-10);
  ASSERT_EQ(result->rpe.size(), 2U);
  EXPECT_GT(result->rpe[0].translation_m.n, 150U);
  EXPECT_DOUBLE_EQ(result->coverage, 1);
  EXPECT_EQ(result->error_m.size(), 200U);
  EXPECT_THAT(result->remarks, IsEmpty());
}

TEST(EvaluateTrajectories, AnotherScaleIsSaidUnlessTheAlignmentTakesItAway) {
  Trajectory in_mm = spiralFrom(0);
  for (StampedPose& pose : in_mm.poses) pose.p *= 1000;
  const auto as_read = evaluateTrajectories(in_mm, spiralFrom(0), {});
  ASSERT_TRUE(as_read->scale_mismatch);
  EXPECT_NEAR(as_read->scale_mismatch->scale, 1e-3, 1e-9);
  EXPECT_FALSE(as_read->clock_mismatch);
  TrajectoryMetricOptions sim3;
  sim3.alignment.kind = AlignmentKind::kSim3;
  EXPECT_FALSE(evaluateTrajectories(in_mm, spiralFrom(0), sim3)->scale_mismatch);
}

TEST(EvaluateTrajectories, PosesThatAreInvertedOrMirroredAreSaid) {
  const Trajectory truth = wayFrom(0);
  Trajectory inverted = truth, mirrored = truth;
  for (StampedPose& pose : inverted.poses) {
    const Transform T_BW = pose.transform().inverse();
    pose.p = T_BW.t;
    pose.q = T_BW.quaternion();
  }
  for (StampedPose& pose : mirrored.poses) pose.p.y() *= -1;
  mirrored.has_orientation = false;
  const auto remarks = [](const Trajectory& estimate, const Trajectory& of_truth) {
    return evaluateTrajectories(estimate, of_truth, {})->remarks;
  };
  EXPECT_THAT(remarks(inverted, truth), Contains(HasSubstr("all poses of the estimate are inver")));
  EXPECT_THAT(remarks(truth, inverted), Contains(HasSubstr("all poses of the truth are inverted")));
  EXPECT_THAT(remarks(mirrored, truth), Contains(HasSubstr("left-handed world")));
}

// A hand-eye transform takes up part of what a late clock does: the truth is looked at as it was
// read.
TEST(EvaluateTrajectories, ALateClockIsSaidUnderHandEyeUnlessItIsEstimated) {
  TrajectoryMetricOptions options;
  for (const bool hand_eye : {false, true}) {
    options.hand_eye = hand_eye;
    const auto run = evaluateTrajectories(wayFrom(0.3), wayFrom(0), options);
    ASSERT_TRUE(run.ok());
    ASSERT_TRUE(run->clock_mismatch) << hand_eye;
    EXPECT_NEAR(run->clock_mismatch->positions_s, -0.3, 0.01);
  }
  // A marker half a metre away: by positions alone the lever arm hides the clock.
  const auto marker = [&](Trajectory way) {
    for (StampedPose& pose : way.poses) pose.p += pose.q * Eigen::Vector3d(0.5, -0.2, 0.3);
    return way;
  };
  const auto arm = evaluateTrajectories(wayFrom(0.2), marker(wayFrom(0)), options);
  ASSERT_TRUE(arm.ok());
  ASSERT_TRUE(arm->clock_mismatch);
  EXPECT_NEAR(arm->clock_mismatch->positions_s, -0.2, 0.01);
  EXPECT_LT(arm->clock_mismatch->moved_ate_m, 0.1 * arm->clock_mismatch->ate_m);
  EXPECT_FALSE(evaluateTrajectories(wayFrom(0), marker(wayFrom(0)), options)->clock_mismatch);
  options.clock = ClockOffsetOptions{};
  const auto known = evaluateTrajectories(wayFrom(0.3), wayFrom(0), options);
  ASSERT_TRUE(known.ok());
  EXPECT_FALSE(known->clock_mismatch);
}

TEST(EvaluateTrajectories, CoverageLeavesOutHoles) {
  Trajectory half = spiralFrom(0);
  half.poses.erase(half.poses.begin() + 50, half.poses.begin() + 149);
  EXPECT_NEAR(evaluateTrajectories(half, spiralFrom(0), {})->coverage, 99 / 199.0, 1e-12);
}

TEST(EvaluateTrajectories, NoOverlapNamesBothSpansAndTheCause) {
  const Failure later = refusal(spiralFrom(1000), spiralFrom(1100));
  EXPECT_EQ(later.code, FailureCode::kNoCommonTime);
  EXPECT_THAT(textOf(later).message,
              AllOf(HasSubstr("no overlap in time"), HasSubstr("from 1000.000"),
                    HasSubstr("to 1019.900"), HasSubstr("from 1100.000")));
  EXPECT_THAT(textOf(later).cure, HasSubstr("--time-offset 100"));
  EXPECT_THAT(textOf(refusal(spiralFrom(1.4e6), spiralFrom(1.4e9))).cure, HasSubstr("unit"));
  EXPECT_THAT(textOf(refusal(spiralFrom(12), spiralFrom(1.4e9))).cure, HasSubstr("epoch"));
  EXPECT_THAT(textOf(refusal(spiralFrom(1.4e9 + 7200), spiralFrom(1.4e9))).cure,
              HasSubstr("time zone"));
  TrajectoryMetricOptions given;
  given.association.time_offset_s = 10;
  const auto still = evaluateTrajectories(spiralFrom(1000), spiralFrom(1100), given);
  EXPECT_THAT(textOf(still.failure()).cure, HasSubstr("--time-offset 100"));
}

TEST(EvaluateTrajectories, TooFewPairsSayHowFarTheStampsAreApart) {
  const Failure between = refusal(spiralFrom(0.05), spiralFrom(0));
  EXPECT_EQ(between.code, FailureCode::kTooFewPartners);
  EXPECT_THAT(textOf(between).message, AllOf(HasSubstr("0 of 200"), HasSubstr("0.05")));
  EXPECT_NEAR(std::abs(between.number("nearest_s")), 0.05, 1e-6);
  TrajectoryMetricOptions options;
  options.association.rule = AssociationRule::kInterpolate;
  EXPECT_EQ(evaluateTrajectories(spiralFrom(0.05), spiralFrom(0), options)->association.matches,
            199U);
  options.association.max_gap_s = 0.05;
  const auto gaps = evaluateTrajectories(spiralFrom(0.05), spiralFrom(0), options);
  EXPECT_EQ(gaps.failure().code, FailureCode::kPartnersInGaps);
  EXPECT_EQ(gaps.failure().number("in_gaps"), 199);
}

TEST(EvaluateTrajectories, RemarksNameTheClockOffset) {
  const auto result = evaluateTrajectories(spiralFrom(0.004), spiralFrom(0), {});
  EXPECT_THAT(result->remarks, Contains(HasSubstr("+4.000 ms")));
}

// Of a truth of 100 Hz the nearest pose is up to 5 ms off, which says nothing of the clocks.
TEST(EvaluateTrajectories, RemarksBlameNoClockForTheGridOfTheTruth) {
  const auto remarks = [](const Trajectory& truth, bool clock_is_known) {
    const Trajectory estimate = spiralFrom(0.004);
    const Association association = associate(estimate, truth, {});
    return remarksOn(association, estimate, truth, clock_is_known);
  };
  EXPECT_THAT(remarks(spiralFrom(0), false), Contains(HasSubstr("clock offset")));
  EXPECT_THAT(remarks(spiralFrom(0), true),
              Contains(AllOf(HasSubstr("+4.000 ms"), HasSubstr("no poses at the estimate's"))));
  Trajectory dense = spiralFrom(0);
  const std::vector<StampedPose> sparse = std::exchange(dense.poses, {});
  for (const StampedPose& pose : sparse) {
    for (int k = 0; k < 10; ++k) {
      dense.poses.push_back(pose);
      dense.poses.back().t += 10'000'000LL * k;
    }
  }
  EXPECT_THAT(remarks(dense, false), Contains(HasSubstr("no poses at the estimate's")));
}

TEST(EvaluateTrajectories, RemarksNamePosesThatEvoUsesTwice) {
  Trajectory estimate = spiralFrom(0);
  estimate.poses.insert(estimate.poses.begin() + 7, estimate.poses[7]);
  estimate.poses.pop_back();
  TrajectoryMetricOptions options;
  options.association.rule = AssociationRule::kEvo;
  const auto result = evaluateTrajectories(estimate, spiralFrom(0), options);
  EXPECT_EQ(result->association.estimate_duplicates, 1U);
  EXPECT_THAT(result->remarks, Contains(HasSubstr("1 poses twice")));
  EXPECT_THAT(evaluateTrajectories(estimate, spiralFrom(0), {})->remarks, IsEmpty());
}

TEST(EvaluateTrajectories, RemarksNameABodyFrameThatDiffers) {
  Trajectory estimate = spiralFrom(0);
  const Eigen::Quaterniond q_BC(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitX()));
  for (StampedPose& pose : estimate.poses) pose.q = pose.q * q_BC;
  const auto result = evaluateTrajectories(estimate, spiralFrom(0), {});
  EXPECT_THAT(result->left_out, HasSubstr("68.8 deg between the body frames"));
  EXPECT_EQ(result->cure, "--hand-eye auto");
  EXPECT_EQ(result->ate_rotation_deg.n, 0U) << "known to be no error, so not shown";
  TrajectoryMetricOptions options;
  options.alignment.kind = AlignmentKind::kSim3;
  EXPECT_EQ(evaluateTrajectories(estimate, spiralFrom(0), options)->cure,
            "--align se3 --hand-eye auto")
      << "hand-eye needs lengths";
}

// A straight way with centimetres of noise: the rotation about it is noise of the fit, no error of
// the estimate, nor another body frame.
TEST(EvaluateTrajectories, RotationsThatTheFitLeavesFreeAreNoErrors) {
  Trajectory estimate = spiralFrom(0), truth = estimate;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const auto k = static_cast<double>(i);
    StampedPose& t = truth.poses[i];
    t.p = {0.1 * k, 0.001 * std::sin(k), 0};
    t.q = Eigen::Quaterniond(Eigen::AngleAxisd(std::sin(0.1 * k), Eigen::Vector3d::UnitX()));
    t.q *= Eigen::Quaterniond(Eigen::AngleAxisd(std::sin(0.17 * k), Eigen::Vector3d::UnitZ()));
    estimate.poses[i].p = t.p + Eigen::Vector3d(0, 0.01 * std::cos(2 * k), 0.01 * std::sin(k));
    estimate.poses[i].q = t.q;
  }
  TrajectoryMetricOptions options;
  options.rpe = {{1, RelativeDelta::Unit::kFrames}};
  const auto result = evaluateTrajectories(estimate, truth, options);
  EXPECT_THAT(result->left_out, AllOf(HasSubstr("the positions hardly determine"),
                                      HasSubstr("rotation errors and NEES are not")));
  EXPECT_EQ(result->cure, "--align se3-first");
  EXPECT_EQ(result->ate_rotation_deg.n, 0U);
  ASSERT_FALSE(result->rpe.empty());
  EXPECT_GT(result->rpe[0].rotation_deg.n, 0U) << "of bodies, whatever their world is";
  options.alignment.kind = AlignmentKind::kSe3First;
  const auto cured = evaluateTrajectories(estimate, truth, options);
  EXPECT_EQ(cured->left_out, "");
  EXPECT_LT(cured->ate_rotation_deg.rmse, 1e-3);
  // A tilt about the way is the estimate's own error where the fit has yaw alone.
  options.alignment.kind = AlignmentKind::kYaw;
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
  for (StampedPose& pose : estimate.poses) pose.q = tilt * pose.q;
  const auto tilted = evaluateTrajectories(estimate, truth, options);
  EXPECT_THAT(tilted->left_out, Not(HasSubstr("hardly determine")));
  EXPECT_NE(tilted->cure, "--align yaw-first");
}

// The first pose's rotation is that of its body as well: aligned by it, the positions are turned.
TEST(EvaluateTrajectories, AnotherBodyIsFoundUnderAnAlignmentByTheFirstPose) {
  Trajectory estimate = spiralFrom(0);
  const Eigen::Quaterniond q_BC(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitX()));
  for (StampedPose& pose : estimate.poses) pose.q = pose.q * q_BC;
  TrajectoryMetricOptions options;
  for (const AlignmentKind kind : {AlignmentKind::kSe3First, AlignmentKind::kOrigin}) {
    options.alignment.kind = kind;
    const auto result = evaluateTrajectories(estimate, spiralFrom(0), options);
    EXPECT_GT(result->ate_translation_m.rmse, 0.1);
    EXPECT_EQ(result->cure, "--hand-eye auto");
    EXPECT_THAT(result->left_out, HasSubstr("turns the positions"));
  }
}

TEST(EvaluateTrajectories, RemarksNameInvertedQuaternions) {
  for (const bool of_truth : {true, false}) {
    Trajectory truth = spiralFrom(0);
    for (std::size_t i = 0; i < truth.poses.size(); ++i) {  // about one axis it could be either
      const double tilt = std::sin(0.3 * static_cast<double>(i));
      truth.poses[i].q *= Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()));
    }
    Trajectory estimate = truth;
    const Eigen::Quaterniond q_WE(Eigen::AngleAxisd(1, Eigen::Vector3d(1, 1, 0).normalized()));
    for (StampedPose& pose : estimate.poses) pose = {pose.t, q_WE * pose.p, q_WE * pose.q};
    for (StampedPose& pose : (of_truth ? truth : estimate).poses) pose.q = pose.q.conjugate();
    const auto result = evaluateTrajectories(estimate, truth, {});
    EXPECT_THAT(result->left_out,
                HasSubstr(of_truth ? "of the truth are inv" : "of the estimate are inv"));
    EXPECT_EQ(result->cure, of_truth ? "--truth-inverted" : "--estimate-inverted");
    EXPECT_LT(result->ate_translation_m.rmse, 1e-9);
    EXPECT_EQ(result->ate_rotation_deg.n, 0U) << "known to be wrong, so not shown";
    EXPECT_THAT(result->rpe, IsEmpty());
  }
}

TEST(EvaluateTrajectories, WithoutOrientationsOnlyPositionsAreJudged) {
  Trajectory truth = spiralFrom(0);
  truth.has_orientation = false;
  TrajectoryMetricOptions options;
  options.rpe = {{1, RelativeDelta::Unit::kMetres}};
  const auto result = evaluateTrajectories(spiralFrom(0), truth, options);
  EXPECT_EQ(result->ate_translation_m.n, 200U);
  EXPECT_EQ(result->ate_rotation_deg.n, 0U);
  EXPECT_THAT(result->rpe, IsEmpty());
  EXPECT_THAT(result->remarks, Contains(HasSubstr("no orientations")));
  options.alignment.kind = AlignmentKind::kSe3First;
  EXPECT_EQ(evaluateTrajectories(spiralFrom(0), truth, options).failure().code,
            FailureCode::kAlignmentNeedsOrientations);
}

TEST(TrajectoryDocument, HoldsTheFieldsThatScriptsRead) {
  TrajectoryMetricOptions options;
  options.rpe = {{2, RelativeDelta::Unit::kSeconds}};
  const auto json = nlohmann::json::parse(documentOf(
      SingleTrajectory{*evaluateTrajectories(spiralFrom(0), spiralFrom(0), options), {}, {}}));
  EXPECT_EQ(json["n"], 200);
  EXPECT_EQ(json["association"], "one-to-one");
  EXPECT_EQ(json["alignment"], "se3");
  EXPECT_EQ(json["scale"], 1);
  EXPECT_NEAR(json["R"][2][2], 1, 1e-12);
  EXPECT_EQ(json["t"].size(), 3U);
  for (const char* name : {"rmse", "mean", "median", "std", "min", "max", "sse", "n"}) {
    EXPECT_TRUE(json["ate"]["translation_m"].contains(name)) << name;
    EXPECT_TRUE(json["ate"]["rotation_deg"].contains(name)) << name;
    EXPECT_TRUE(json["rpe"][0]["translation_m"].contains(name)) << name;
  }
  EXPECT_EQ(json["rpe"][0]["delta"], 2);
  EXPECT_EQ(json["rpe"][0]["unit"], "s");
}

}  // namespace
}  // namespace plumbline
