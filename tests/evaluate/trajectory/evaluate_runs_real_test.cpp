// SPDX-License-Identifier: BSD-3-Clause
// Real runs on MH_01: OpenVINS under wrong calibrations, ORB-SLAM3 with its keyframes.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/trajectory/evaluate_runs.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const std::string kFolder = PLUMBLINE_SHARED_DATA "/trajectories/";

TrajectoryRecord judged(const std::string& runs, double min_coverage, int threads = 0) {
  RunsRequest request;
  request.runs = kFolder + runs;
  request.truth = kFolder + "{sequence}_01_easy_groundtruth.txt";
  if (runs.find("{sequence}") == std::string::npos) {
    request.truth = kFolder + "MH_01_easy_groundtruth.txt";
  }
  request.min_coverage = min_coverage;
  request.threads = threads;
  return evaluateRuns(request);
}

double ateOf(const TrajectoryRecord& record, const std::string& calibration) {
  for (const TrajectoryRun& run : record.runs) {
    if (run.calibration == calibration) return run.ate_translation_m.rmse;
  }
  ADD_FAILURE() << calibration;
  return 0;
}

const std::string kOpenVins =
    "openvins_wrong_calibration/openvins_MH01_{calibration}_full_{run}.tum";

TEST(EvaluateRunsReal, WrongCalibrationsHaveLargerErrors) {
  const TrajectoryRecord record = judged(kOpenVins, 0.7);
  ASSERT_EQ(record.runs.size(), 4U);
  const double nominal = ateOf(record, "nominal");
  EXPECT_NEAR(nominal, 0.0955, 5e-5);
  for (const char* wrong : {"rot_z_1deg", "rot_z_5deg", "trans_y_5cm"}) {
    EXPECT_GT(ateOf(record, wrong), nominal) << wrong;
  }
  for (const TrajectoryRun& run : record.runs) EXPECT_EQ(run.status, RunStatus::kComplete);
  for (const PairedDifference& d : record.paired) {
    if (d.a == "nominal") {
      EXPECT_GT(d.mean_m, 0) << d.b;
    }
  }
}

TEST(EvaluateRunsReal, OpenVinsStartsLateWhichIsPartialByTheDefault) {
  for (const TrajectoryRun& run : judged(kOpenVins, 0.9).runs) {
    EXPECT_EQ(run.status, RunStatus::kPartial);
    EXPECT_THAT(run.problem, HasSubstr("% of the truth's time"));
  }
}

TEST(EvaluateRunsReal, KeyframesArePartialAndMissingRunsFailed) {
  const TrajectoryRecord record = judged("orbslam3_MH01/run{run}_{calibration}.txt", 0.9);
  // Runs 1, 2, 3 of kf_stereo, mono, monoi, stereo: twelve expected, six there.
  ASSERT_EQ(record.runs.size(), 12U);
  std::size_t missing = 0;
  for (const TrajectoryRun& run : record.runs) {
    if (run.estimate.empty()) {
      ++missing;
      EXPECT_EQ(run.status, RunStatus::kFailed);
    }
    if (run.calibration == "stereo") {
      EXPECT_EQ(run.status, RunStatus::kComplete) << run.problem;
      EXPECT_LT(run.ate_translation_m.rmse, 0.045);
    }
    if (run.calibration == "kf_stereo" && run.run == "1") {
      EXPECT_EQ(run.status, RunStatus::kPartial) << run.coverage;
    }
  }
  EXPECT_EQ(missing, 6U);
  for (const RunsSummary& s : record.summary) {
    EXPECT_EQ(s.expected, 3U);
    if (s.calibration == "stereo") {
      EXPECT_EQ(s.completion, 1);
    }
  }
}

TEST(EvaluateRunsReal, DoesNotDependOnThreads) {
  const TrajectoryRecord one = judged(kOpenVins, 0.7, 1), four = judged(kOpenVins, 0.7, 4);
  EXPECT_EQ(documentOf(one), documentOf(four));
}

}  // namespace
}  // namespace plumbline
