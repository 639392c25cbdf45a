// SPDX-License-Identifier: BSD-3-Clause
// What the verdict of trajectories says first, and which level it has.
#include "evaluate/metrics/trajectory/verdict.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

TrajectoryRun completeRun(const std::string& calibration, const std::string& run) {
  TrajectoryRun r;
  r.sequence = "MH_01";
  r.calibration = calibration;
  r.run = run;
  r.coverage = 0.98;
  r.association.matches = 2310;
  r.alignment.kind = "se3";
  r.ate_translation_m.rmse = 0.0543;
  r.ate_translation_m.n = 2310;
  return r;
}

TrajectoryStudy studyOf(std::vector<TrajectoryRun> runs) {
  TrajectoryStudy study;
  RunsSummary all;
  all.calibration = runs.front().calibration;
  for (const TrajectoryRun& r : runs) {
    ++all.expected;
    ++(r.status == RunStatus::kComplete  ? all.complete
       : r.status == RunStatus::kPartial ? all.partial
                                         : all.failed);
  }
  all.level = all.failed > 0    ? VerdictLevel::kBad
              : all.partial > 0 ? VerdictLevel::kCaution
                                : VerdictLevel::kGood;
  all.ate_median_m = 0.0543;
  study.summary = {all};
  study.runs = std::move(runs);
  return study;
}

TEST(TrajectoryVerdict, OfOneRunSaysHowFarItIsFromTheTruth) {
  const Verdict v = trajectoryVerdict(studyOf({completeRun("", "1")}));
  EXPECT_EQ(v.level, VerdictLevel::kGood);
  EXPECT_EQ(v.headline,
            "The estimate is 0.0543 m RMSE from the truth (se3 alignment, 2310 pairs, 98 % of the "
            "truth's time).");
}

TEST(TrajectoryVerdict, AnotherScaleIsNeverGoodAndUnitsAreNamed) {
  TrajectoryRun run = completeRun("", "1");
  run.scale_mismatch = ScaleMismatch{1002, 2297, 53.7};
  const Verdict mm = trajectoryVerdict(studyOf({completeRun("", "0"), run}));
  EXPECT_EQ(mm.level, VerdictLevel::kCaution);
  EXPECT_THAT(mm.headline, HasSubstr("the file of the truth is in mm, convert it"));
  EXPECT_THAT(mm.headline, HasSubstr("1 of 2 runs; MH_01 1: "));
  run.scale_mismatch = ScaleMismatch{0.0099, 2297, 0.0537};
  EXPECT_THAT(trajectoryVerdict(studyOf({run})).headline,
              HasSubstr("the file of the estimate is in cm"));
  run.scale_mismatch = ScaleMismatch{3.1, 2.3, 0.0537};  // no unit that anybody writes
  EXPECT_THAT(trajectoryVerdict(studyOf({run})).headline,
              AllOf(HasSubstr("--align sim3"), Not(HasSubstr("convert"))));
}

TEST(TrajectoryVerdict, AScaleStandsBeforeTheDivergenceThatItMakes) {
  TrajectoryRun run = completeRun("", "1");
  run.status = RunStatus::kPartial;
  run.problem = "diverged: ATE 2271.040 m";
  run.scale_mismatch = ScaleMismatch{1e-3, 2271, 0.0471};
  EXPECT_THAT(trajectoryVerdict(studyOf({run})).headline,
              HasSubstr(" Scale: lengths of the truth"));
}

TEST(TrajectoryVerdict, AnotherOffsetOfTheClocksIsNeverGoodAndTheRatesTellItsCause) {
  TrajectoryRun run = completeRun("", "1");
  const auto headlineWith = [&](std::optional<double> rates_s, double positions_s = -0.5) {
    run.clock_mismatch = ClockMismatch{0.25, positions_s, rates_s, "se3", 0.176, 0.0535};
    const Verdict v = trajectoryVerdict(studyOf({run}));
    EXPECT_EQ(v.level, VerdictLevel::kCaution);
    EXPECT_THAT(v.headline, HasSubstr("the RMSE is 0.0535 m, as they are 0.176 m (after se3)"));
    return v.headline;
  };
  EXPECT_THAT(headlineWith(-0.49),
              AllOf(HasSubstr("--clock-offset auto"), HasSubstr("angular rates ask for -0.490 s"),
                    Not(HasSubstr("--clock-range"))));
  EXPECT_THAT(headlineWith(-1.3, -1.31), HasSubstr("--clock-offset auto --clock-range 3"));
  EXPECT_THAT(headlineWith(0.001),
              AllOf(HasSubstr("clocks are not off so far"), HasSubstr("--hand-eye auto")));
  EXPECT_THAT(headlineWith(std::nullopt), HasSubstr("the clocks are off, run again with "
                                                    "--time-offset -0.2500 in all"));
}

TEST(TrajectoryVerdict, MismatchesAreSaidOfEachCalibration) {
  TrajectoryRun late = completeRun("kalibr", "1"), worse = completeRun("kalibr", "2");
  late.clock_mismatch = ClockMismatch{0, -0.3, -0.3, "se3", 0.12, 0.0535};
  worse.clock_mismatch = ClockMismatch{0, -0.5, -0.5, "se3", 0.176, 0.0535};
  TrajectoryStudy study = studyOf({late, worse, completeRun("ours", "1")});
  study.summary.push_back(study.summary[0]);
  study.summary[1].calibration = "ours";
  std::vector<std::string> clocks;
  for (const Finding& f : trajectoryVerdict(study).findings) {
    if (f.rule.starts_with("Clocks")) clocks.push_back(f.rule + ": " + f.evidence);
  }
  ASSERT_THAT(clocks, SizeIs(1));
  EXPECT_THAT(clocks[0], HasSubstr("Clocks of kalibr: 2 of 2 runs; MH_01 2: "));
}

TEST(TrajectoryVerdict, WithoutACompleteRunSaysSo) {
  TrajectoryRun run = completeRun("ours", "1");
  run.status = RunStatus::kPartial;
  run.problem = "covers 80.0 % of the truth's time, less than 90 %";
  TrajectoryStudy study = studyOf({run, run});
  study.summary[0].ate_median_m.reset();
  const Verdict v = trajectoryVerdict(study);
  EXPECT_EQ(v.level, VerdictLevel::kCaution);
  EXPECT_EQ(v.headline.rfind("No run is complete.", 0), 0u) << v.headline;
  EXPECT_THAT(v.headline, Not(HasSubstr("unknown")));
}

TEST(TrajectoryVerdict, AMedianMayBeUnknownThoughSomeRunsAreComplete) {
  TrajectoryRun failed = completeRun("ours", "2");
  failed.status = RunStatus::kFailed;
  TrajectoryStudy study = studyOf({completeRun("ours", "1"), failed});
  study.summary[0].ate_median_m.reset();
  EXPECT_THAT(trajectoryVerdict(study).headline,
              HasSubstr("Median ATE of ours unknown (half or more of the runs with a ground truth "
                        "are not complete)"));
}

TEST(TrajectoryVerdict, RunsWithoutTruthAreCompleteAndHaveNoError) {
  TrajectoryRun run = completeRun("ours", "1");
  run.without_truth = true;
  TrajectoryStudy study = studyOf({run, run});
  study.summary[0].ate_median_m.reset();
  EXPECT_EQ(trajectoryVerdict(study).headline, "There is no ground truth, and so no error.");
}

TEST(TrajectoryVerdict, OfOneSequenceCountsItsRows) {
  TrajectoryStudy study = studyOf({completeRun("ours", "1"), completeRun("ours", "2")});
  study.summary[0].sequence = "MH_01";
  const Verdict v = trajectoryVerdict(study);
  EXPECT_THAT(v.findings, SizeIs(1));
  EXPECT_EQ(v.headline, "Median ATE of ours 0.0543 m.");
}

TEST(TrajectoryVerdict, AFailedRunIsBadAndNamedWithItsReason) {
  TrajectoryRun failed = completeRun("ours", "2");
  failed.status = RunStatus::kFailed;
  failed.problem = "diverged: ATE 9.100 m";
  const Verdict v = trajectoryVerdict(studyOf({completeRun("ours", "1"), failed}));
  EXPECT_EQ(v.level, VerdictLevel::kBad);
  EXPECT_THAT(v.headline, HasSubstr("Median ATE of ours 0.0543 m"));
  EXPECT_THAT(v.headline, HasSubstr("1 of 2 complete"));
  EXPECT_THAT(v.headline, HasSubstr("diverged: ATE 9.100 m"));
}

// A partial run and a failed one: the worse one's reason is told, and none of another calibration.
TEST(TrajectoryVerdict, TheReasonIsOfTheWorstRunOfThatCalibration) {
  TrajectoryRun of_other = completeRun("kalibr", "1"), partial = completeRun("ours", "2"),
                failed = completeRun("ours", "3");
  of_other.status = failed.status = RunStatus::kFailed;
  partial.status = RunStatus::kPartial;
  of_other.problem = "no file";
  partial.problem = "covers 88.3 %";
  failed.problem = "diverged";
  TrajectoryStudy study = studyOf({partial, failed});
  study.runs.insert(study.runs.begin(), of_other);
  const std::string evidence = trajectoryVerdict(study).findings[0].evidence;
  EXPECT_THAT(evidence, HasSubstr("MH_01 3: diverged"));
  EXPECT_THAT(evidence, Not(HasSubstr("no file")));
}

TEST(TrajectoryVerdict, OfOneRunTheOrientationIsSaidWhereItIsKnown) {
  TrajectoryRun run = completeRun("", "1");
  run.ate_rotation_deg.rmse = 1.24;
  run.ate_rotation_deg.n = 1;
  EXPECT_THAT(trajectoryVerdict(studyOf({run})).headline,
              HasSubstr(", its orientation 1.24 deg RMSE."));
}

// A mirrored axis, or a clock half a second off: positions may fit all the same.
TEST(TrajectoryVerdict, AnOrientationFarOffIsACaution) {
  TrajectoryStudy study = studyOf({completeRun("", "1")});
  study.runs[0].ate_rotation_deg.n = 10;
  study.runs[0].ate_rotation_deg.rmse = 4;
  EXPECT_EQ(trajectoryVerdict(study).level, VerdictLevel::kGood);
  study.runs[0].ate_rotation_deg.rmse = 178.5;
  const Verdict verdict = trajectoryVerdict(study);
  EXPECT_EQ(verdict.level, VerdictLevel::kCaution);
  const auto f = std::ranges::find(verdict.findings, "Orientation", &Finding::rule);
  ASSERT_NE(f, verdict.findings.end());
  EXPECT_THAT(f->evidence, HasSubstr("the worst 178 deg"));
  EXPECT_THAT(f->advice, HasSubstr("--clock-offset auto"));
}

TEST(TrajectoryVerdict, ARunWithoutNamesHasItsReasonAlone) {
  TrajectoryRun partial = completeRun("ours", "");
  partial.sequence.clear();
  partial.status = RunStatus::kPartial;
  partial.problem = "covers 88.3 %";
  const Verdict v = trajectoryVerdict(studyOf({partial, partial}));
  EXPECT_THAT(v.findings[0].evidence, HasSubstr("0 failed; covers 88.3 %"));
}

TEST(TrajectoryVerdict, ACalibrationIsBetterOnlyBeyondItsInterval) {
  TrajectoryStudy study = studyOf({completeRun("ours", "1"), completeRun("ours", "2")});
  PairedDifference d;
  d.a = "kalibr", d.b = "ours", d.pairs = 6, d.mean_m = -0.02;
  study.paired = {d};
  EXPECT_THAT(trajectoryVerdict(study).headline,
              HasSubstr("ours and kalibr were not shown to differ"));
  study.paired[0].low_m = -0.03, study.paired[0].high_m = -0.01, study.paired[0].better = "ours";
  EXPECT_THAT(trajectoryVerdict(study).headline,
              HasSubstr("ours is better than kalibr by 0.02 m (95 % interval 0.01 to 0.03)"));
}

TEST(TrajectoryVerdict, ACureThatIsAnOptionIsCautionAndSaidOnce) {
  TrajectoryRun run = completeRun("ours", "1");
  run.remarks = {"the poses are 0.05 s apart"};
  run.left_out = "the quaternions of the truth are inverted";
  run.cure = "--truth-inverted";
  TrajectoryRun other = run;
  other.run = "2";
  const Verdict v = trajectoryVerdict(studyOf({run, other}));
  EXPECT_EQ(v.level, VerdictLevel::kCaution);
  EXPECT_THAT(v.headline, HasSubstr("--truth-inverted"));
  EXPECT_THAT(v.findings, SizeIs(2));
  EXPECT_THAT(v.headline, Not(HasSubstr("apart")));
}

TEST(TrajectoryVerdict, CovariancesThatAreTooSmallAreCaution) {
  TrajectoryRun run = completeRun("", "1");
  NeesRecord nees;
  nees.mean = 9, nees.lower = 2.9, nees.upper = 3.1;
  run.nees = {nees};
  const Verdict v = trajectoryVerdict(studyOf({run}));
  EXPECT_EQ(v.level, VerdictLevel::kCaution);
  EXPECT_THAT(v.headline, HasSubstr("2.9 times"));
  run.nees[0].mean = 3;
  EXPECT_EQ(trajectoryVerdict(studyOf({run})).level, VerdictLevel::kGood);
}

}  // namespace
}  // namespace plumbline
