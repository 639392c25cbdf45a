// SPDX-License-Identifier: BSD-3-Clause
// What a night says of steps that failed, or have no result.
#include "evaluate/study/merge.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/fields/json_fields.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

/// A session with a calibration, another tool's, and two held-out recordings.
class MergeTest : public testing::Test {
 protected:
  MergeTest() {
    SessionEntry session;
    session.row.name = "a";
    study_.sessions = {session};
    study_.offsets_ms = {100, 1};
    StudyRecord calibrated;
    calibrated.sessions = {session.row};
    calibrated.sessions[0].verdict = VerdictLevel::kGood;
    done(StepKind::kCalibrate, "calibrate", "", calibrated);
    StudyRecord compared;
    compared.others = {{"a", "kalibr", {}, {}, ""}};
    done(StepKind::kCompare, "compare_kalibr", "kalibr", compared);
    StudyRecord scored;
    scored.held_out = {{"a", "e1", 1.0, ""}};
    done(StepKind::kEvaluate, "evaluate_e1", "e1", scored);
    done(StepKind::kEvaluate, "evaluate_kalibr_e1", "kalibr/e1", scored);
  }

  Step& add(StepKind kind, const std::string& name, const std::string& part) {
    Step step;
    step.kind = kind;
    step.name = "sessions/a/" + name;
    step.session = "a";
    step.part = part;
    steps_.push_back(step);
    return steps_.back();
  }
  void done(StepKind kind, const std::string& name, const std::string& part,
            const StudyRecord& rows) {
    const Step& step = add(kind, name, part);
    folder_.write(step.name + "/step.json", stepText(results_[step.name], rows));
  }
  void failed(StepKind kind, const std::string& name, const std::string& part) {
    StepResult& result = results_[add(kind, name, part).name];
    result.status = StepStatus::kFailed;
    result.message = "too few corners";
  }
  StudyRecord merged() {
    night_ = mergeNight(study_, folder_.path(), steps_, results_);
    return night_.record;
  }
  std::map<std::string, double> failures() {
    merged();
    std::map<std::string, double> found;
    for (const StudyFigure& f : night_.figures) {
      if (f.name.starts_with("failed")) found[f.name] = f.value;
    }
    return found;
  }

  TemporaryFolder folder_;
  StudyDefinition study_;
  std::vector<Step> steps_;
  StepResults results_;
  MergedNight night_;
};

TEST_F(MergeTest, AnErrorOverRecordingsIsOverAllOfThem) {
  EXPECT_EQ(merged().sessions[0].held_out_rmse_px, 1);
  EXPECT_EQ(merged().others[0].held_out_rmse_px, 1);
  failed(StepKind::kEvaluate, "evaluate_e2", "e2");
  failed(StepKind::kEvaluate, "evaluate_kalibr_e2", "kalibr/e2");
  const StudyRecord record = merged();
  EXPECT_FALSE(record.sessions[0].held_out_rmse_px);
  EXPECT_FALSE(record.others[0].held_out_rmse_px);
  ASSERT_EQ(record.held_out.size(), 2u);
  EXPECT_EQ(record.held_out[1].failure, "too few corners");
}

TEST_F(MergeTest, AStepThatWasLeftOutCountsAndSaysWhy) {
  failed(StepKind::kDetect, "detect", "");
  add(StepKind::kEvaluate, "evaluate_e2", "e2").needs = {{"sessions/a/detect", ""}};
  add(StepKind::kEvaluate, "evaluate_kalibr_e2", "kalibr/e2");
  const StudyRecord record = merged();
  EXPECT_FALSE(record.sessions[0].held_out_rmse_px);
  EXPECT_FALSE(record.others[0].held_out_rmse_px);
  ASSERT_EQ(record.held_out.size(), 2u);
  EXPECT_EQ(record.held_out[1].failure, "too few corners");
  EXPECT_EQ(night_.steps_left_out, 1);
  EXPECT_THAT(record.verdict.findings[1].evidence,
              HasSubstr("1 of 7 steps failed, 1 that need them were left out, 1 were not done"));
}

// A session of images whose detection fails has no calibration, and its figures would vanish
// without an alarm.
TEST_F(MergeTest, AStepThatWasLeftOutForAFailureHasFailed) {
  failed(StepKind::kDetect, "detect", "");
  results_["sessions/a/detect"].version = "7";
  results_["sessions/a/detect"].command = "plumbline detect";
  add(StepKind::kEstimate, "estimate", "s1").needs = {{"sessions/a/detect", ""}};
  add(StepKind::kPerturb, "perturb", "").needs = {{"sessions/a/calibrate", ""},
                                                  {"sessions/a/estimate", ""}};
  steps_.back().inputs_key = "inputs";
  const auto now = failures();
  EXPECT_EQ(now.at("failed/estimate"), 1);
  EXPECT_EQ(now.at("failed/perturb"), 1);
  EXPECT_EQ(now.at("failed"), 0);
  const StudyFigure& figure = night_.figures.back();
  EXPECT_EQ(figure.name, "failed/perturb");
  EXPECT_EQ(figure.inputs_key, "inputs");
  EXPECT_EQ(figure.version, "7");
  EXPECT_EQ(figure.command, "plumbline detect");
}

// Killed, beyond its limits, without room: it is tried again, and until then nobody has its
// figures.
TEST_F(MergeTest, AStepThatWasLostHasFailed) {
  results_["sessions/a/calibrate"].status = StepStatus::kLost;
  add(StepKind::kEvaluate, "evaluate_e2", "e2").needs = {{"sessions/a/calibrate", ""}};
  auto now = failures();
  EXPECT_EQ(now.at("failed"), 1);
  EXPECT_EQ(now.at("failed/evaluate_e2"), 1);
  EXPECT_EQ(now.at("failed/evaluate_e1"), 0);
  results_["sessions/a/calibrate"].status = StepStatus::kChanged;
  now = failures();
  EXPECT_EQ(now.count("failed"), 0u) << "no state of the data failed";
  EXPECT_EQ(now.count("failed/evaluate_e2"), 0u);
}

TEST_F(MergeTest, AFigureThatIsMissingIsAFailure) {
  EXPECT_EQ(failures(), (std::map<std::string, double>{{"failed", 0}, {"failed/evaluate_e1", 0}}));
  StudyRecord none, nan;
  none.trajectories = {{"a", "s1", "", std::nullopt, "diverged"}};
  nan.held_out = {{"a", "e2", std::nan(""), ""}};
  done(StepKind::kTrajectory, "trajectory_s1", "s1", none);
  done(StepKind::kEvaluate, "evaluate_e2", "e2", nan);
  failed(StepKind::kPerturb, "perturb", "");
  const auto now = failures();
  EXPECT_EQ(now.at("failed/trajectory_s1"), 1);
  EXPECT_EQ(now.at("failed/evaluate_e2"), 1);
  EXPECT_EQ(now.at("failed/perturb"), 1);
  EXPECT_EQ(now.at("failed/evaluate_e1"), 0);
}

TEST_F(MergeTest, ASessionWithoutACalibrationHasNoVerdict) {
  EXPECT_EQ(merged().sessions[0].verdict, VerdictLevel::kGood);
  results_["sessions/a/calibrate"].status = StepStatus::kFailed;
  const StudyRecord record = merged();
  EXPECT_EQ(record.sessions[0].status, StudyStatus::kFailed);
  EXPECT_FALSE(record.sessions[0].verdict);
  EXPECT_FALSE(toJson(record.sessions[0]).contains("verdict"));
}

// A session whose lens model was chosen otherwise has another entropy for that reason alone.
TEST(Merge, EntropiesAreOfOneListOfParameters) {
  const auto session = [](const std::vector<std::string>& names) {
    StudySession s;
    s.camera_entropy_nats = -90;
    s.camera_imu_entropy_nats = -40;
    for (const std::string& name : names) s.estimates.emplace_back().name = name;
    return s;
  };
  const std::vector<std::string> radtan{"cam0.fu", "cam0.p1", "T_SC0.tx"};
  const std::vector<std::string> other{"cam0.fu", "cam0.k3", "T_SC0.tx"};
  std::vector<StudySession> sessions{session(other), session(radtan), session(radtan), {}};
  keepComparableEntropies(sessions);
  EXPECT_FALSE(sessions[0].camera_entropy_nats);
  EXPECT_TRUE(sessions[0].camera_imu_entropy_nats) << "of T_SC0 and the offset";
  EXPECT_TRUE(sessions[1].camera_entropy_nats);
  EXPECT_TRUE(sessions[2].camera_entropy_nats);
  EXPECT_FALSE(sessions[3].camera_entropy_nats) << "failed";
  std::vector<StudySession> alike{session(other), session(other)};
  keepComparableEntropies(alike);
  EXPECT_TRUE(alike[0].camera_entropy_nats && alike[1].camera_entropy_nats);
}

TEST_F(MergeTest, AFailedPerturbationIsOneOfEveryOffset) {
  failed(StepKind::kPerturb, "perturb", "");
  const StudyRecord record = merged();
  ASSERT_EQ(record.perturbations.size(), 2u);
  EXPECT_EQ(record.perturbations[0].offset_ms, 100);
  EXPECT_EQ(record.perturbations[1].offset_ms, 1);
  EXPECT_EQ(record.perturbations[1].failure, "too few corners");
}

}  // namespace
}  // namespace plumbline
