// SPDX-License-Identifier: BSD-3-Clause
// Patterns of files, and that no run is ever dropped: missing, unreadable, short, diverged.
#include "evaluate/trajectory/evaluate_runs.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "evaluate/trajectory/find_runs.h"
#include "evaluate/trajectory/summary.h"
#include "report/records/documents.h"
#include "tests/datasets/trajectory/write_tum.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A spiral of 20 s at 10 Hz, with `wobble` [m] on it and its last poses cut.
Trajectory spiral(double wobble, int poses = 200) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    const double a = 0.1 * i;
    trajectory.poses.push_back(
        {1'000'000'000'000 + 100'000'000LL * i,
         {2 * std::cos(a) + wobble * std::sin(7 * a), 2 * std::sin(a), 0.1 * a},
         Eigen::Quaterniond(Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()))});
  }
  return trajectory;
}

class EvaluateRuns : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("plumbline_runs_" + std::to_string(getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    put("truth/MH_01.txt", spiral(0));
    put("truth/MH_02.txt", spiral(0));
    for (const char* sequence : {"MH_01", "MH_02"}) {
      for (const int run : {0, 1, 2}) {
        const std::string name = std::string(sequence) + "_" + std::to_string(run) + ".txt";
        put("results/good/" + name, spiral(0.01 + 0.001 * run));
        put("results/poor_one/" + name, spiral(0.05 + 0.002 * run));
      }
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  void put(const fs::path& name, const Trajectory& trajectory) const {
    fs::create_directories((folder_ / name).parent_path());
    writeTum(folder_ / name, trajectory);
  }
  RunsRequest request() const {
    RunsRequest r;
    r.runs = (folder_ / "results/{calibration}/{sequence}_{run}.txt").string();
    r.truth = (folder_ / "truth/{sequence}.txt").string();
    return r;
  }
  const TrajectoryRun& find(const TrajectoryRecord& record, const std::string& calibration,
                            const std::string& sequence, const std::string& run) const {
    for (const TrajectoryRun& r : record.runs) {
      if (r.calibration == calibration && r.sequence == sequence && r.run == run) return r;
    }
    throw std::runtime_error("no such run");
  }

  fs::path folder_;
};

TEST_F(EvaluateRuns, FieldsAreReadFromNames) {
  const auto files = findRuns(request().runs);
  ASSERT_EQ(files.size(), 12U);
  EXPECT_EQ(files[0].calibration, "good");
  EXPECT_EQ(files[0].sequence, "MH_01");
  EXPECT_EQ(files[0].run, "0");
  const std::string flat = (folder_ / "flat/{sequence}_{calibration}_{run}.txt").string();
  put("flat/MH_01_rot_z_5deg_3.txt", spiral(0));
  const auto known = findRuns(flat, {"MH_01", "MH"});
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known[0].sequence, "MH_01");
  EXPECT_EQ(known[0].calibration, "rot_z_5deg");
  EXPECT_EQ(known[0].run, "3");
}

TEST_F(EvaluateRuns, BadPatternsAreRefused) {
  EXPECT_THROW(findRuns("{folder}/x.txt"), InputError);
  EXPECT_THROW(findRuns("{run/x.txt"), InputError);
  EXPECT_THROW(findRuns((folder_ / "none/{run}.txt").string()), InputError);
  RunsRequest nothing = request();
  nothing.runs = (folder_ / "results/{calibration}/{sequence}.{run}.csv").string();
  EXPECT_THROW(evaluateRuns(nothing), InputError);
  RunsRequest truth = request();
  truth.truth = (folder_ / "truth/{run}.txt").string();
  EXPECT_THROW(evaluateRuns(truth), InputError);
}

// Without _{run} the sequences are "MH_01_0", ..., of which no truth is.
TEST_F(EvaluateRuns, PatternsThatGoTogetherInNothingAreRefusedByTheNamesFound) {
  RunsRequest r = request();
  r.runs = (folder_ / "results/{calibration}/{sequence}.txt").string();
  try {
    static_cast<void>(evaluateRuns(r));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("'MH_01_0'"), HasSubstr("and 1 more"),
                                             HasSubstr("'MH_02'"), HasSubstr("{run}")));
  }
  fs::remove(folder_ / "truth/MH_02.txt");
  const TrajectoryRecord record = evaluateRuns(request());
  EXPECT_THAT(find(record, "good", "MH_02", "0").problem,
              testing::AllOf(HasSubstr("'MH_02'"), HasSubstr("'MH_01'")));
}

TEST_F(EvaluateRuns, CompleteRunsAreSummarisedAndPaired) {
  const TrajectoryRecord record = evaluateRuns(request());
  ASSERT_EQ(record.runs.size(), 12U);
  const auto summary = record.summary;
  ASSERT_EQ(summary.size(), 6U);  // two sequences and all, of two calibrations
  for (const RunsSummary& s : summary) EXPECT_EQ(s.completion, 1);
  EXPECT_NEAR(*summary[0].ate_median_m, find(record, "good", "MH_01", "1").ate_translation_m.rmse,
              1e-15);
  const auto paired = record.paired;
  ASSERT_EQ(paired.size(), 1U);
  EXPECT_EQ(paired[0].pairs, 6U);
  EXPECT_EQ(paired[0].b_better, 0U);
  EXPECT_NEAR(paired[0].median_m,
              find(record, "poor_one", "MH_01", "1").ate_translation_m.rmse -
                  find(record, "good", "MH_01", "1").ate_translation_m.rmse,
              1e-12);
}

TEST(RunsSummary, NamesOfAnyLengthKeepTheirColumns) {
  TrajectoryStudy study;
  for (const char* calibration : {"a", "of_kalibr_with_the_corner_filter"}) {
    RunsSummary& runs = study.summary.emplace_back();
    runs.sequence = "euroc_vicon_room_V2_02";
    runs.calibration = calibration;
  }
  const std::string text = runsSummary(study);
  EXPECT_THAT(text, HasSubstr("euroc_vicon_room_V2_02  a  "));
  EXPECT_THAT(text, HasSubstr("euroc_vicon_room_V2_02  of_kalibr_with_the_corner_filter  "));
  std::istringstream lines(text);
  std::string head, first, second;
  std::getline(std::getline(std::getline(lines, head), first), second);
  EXPECT_EQ(head.size(), first.size());
  EXPECT_EQ(first.size(), second.size());
}

TEST_F(EvaluateRuns, NothingIsDropped) {
  fs::remove(folder_ / "results/good/MH_01_0.txt");
  std::ofstream(folder_ / "results/good/MH_01_1.txt") << "1.0 2 3\n";
  put("results/good/MH_01_2.txt", spiral(0.001, 150));
  put("results/good/MH_02_0.txt", spiral(30));
  put("results/good/V1_01_0.txt", spiral(0));
  const TrajectoryRecord record = evaluateRuns(request());
  ASSERT_EQ(record.runs.size(), 14U);
  const auto expect = [&](const char* sequence, const char* run, RunStatus status,
                          const char* words) {
    const TrajectoryRun& r = find(record, "good", sequence, run);
    EXPECT_EQ(r.status, status) << sequence << run;
    EXPECT_THAT(r.problem, HasSubstr(words));
    EXPECT_EQ(r.t.empty(), status == RunStatus::kFailed);
    EXPECT_EQ(r.ate_translation_m.n == 0, status == RunStatus::kFailed);
  };
  expect("MH_01", "0", RunStatus::kFailed, "no file");
  expect("MH_01", "1", RunStatus::kFailed, "MH_01_1.txt:1");
  expect("MH_01", "2", RunStatus::kPartial, "covers 74.9 %");
  expect("MH_02", "0", RunStatus::kFailed, "diverged");
  expect("V1_01", "0", RunStatus::kFailed, "no truth");
  const auto summary = record.summary;
  EXPECT_EQ(summary[0].calibration, "good");
  EXPECT_EQ(summary[0].expected, 3U);
  EXPECT_EQ(summary[0].complete, 0U);
  EXPECT_FALSE(summary[0].ate_median_m);
  EXPECT_EQ(summary[2].complete, 2U);  // MH_02: one diverged, the median is the worse of two
  EXPECT_NEAR(*summary[2].ate_median_m, find(record, "good", "MH_02", "2").ate_translation_m.rmse,
              1e-15);
  EXPECT_EQ(record.paired[0].pairs, 2U);
  EXPECT_EQ(record.paired[0].left_out, 5U);
}

// What moves otherwise than its truth: least squares over the scale shrinks it to a point.
TEST_F(EvaluateRuns, AFreeScaleDoesNotHideDivergence) {
  Trajectory lost = spiral(0);
  for (StampedPose& pose : lost.poses) {
    const double a = secondsBetween(lost.poses[0].t, pose.t);
    pose.p = {5 * std::cos(0.3 * a * a), 5 * std::sin(0.3 * a * a), 3 * std::sin(a)};
  }
  put("results/good/MH_01_0.txt", lost);
  RunsRequest r = request();
  r.how.metrics.alignment.kind = AlignmentKind::kSim3;
  const TrajectoryRecord record = evaluateRuns(r);
  EXPECT_THAT(find(record, "good", "MH_01", "0").problem,
              HasSubstr("half the ATE of an estimate that never moves"));
  EXPECT_EQ(find(record, "good", "MH_01", "1").status, RunStatus::kComplete);
}

TEST_F(EvaluateRuns, ThreadsDoNotMatterAndTheFilesSayAll) {
  RunsRequest one = request(), many = request();
  one.threads = 1;
  many.threads = 5;
  const TrajectoryRecord record = evaluateRuns(one);
  EXPECT_EQ(documentOf(record), documentOf(evaluateRuns(many)));
  const auto json = nlohmann::json::parse(documentOf(record));
  EXPECT_EQ(json["runs"].size(), 12U);
  EXPECT_EQ(json["runs"][0]["status"], "complete");
  EXPECT_EQ(json["summary"].size(), 6U);
  const std::string table = runsTable(record);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 13);
}

TEST(CoverageText, HasTheDigitsThatMakeItTrue) {
  EXPECT_EQ(coverageText(0.749, 0.9, "the truth's"),
            "covers 74.9 % of the truth's time, less than 90 %");
  EXPECT_EQ(coverageText(0.89959, 0.9, "the images'"),
            "covers 89.96 % of the images' time, less than 90 %");
  EXPECT_EQ(coverageText(0.899996, 0.9, "the truth's"),
            "covers 89.9996 % of the truth's time, less than 90 %");
}

}  // namespace
}  // namespace plumbline
