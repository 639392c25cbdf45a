// SPDX-License-Identifier: BSD-3-Clause
// Studies of a simulated recording: what must come back, what must move and by how much.
#include "evaluate/studies/perturbation_study.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/simulate_session.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Kind = PerturbationKind;

constexpr double kCornerSigma = 0.2;

const SimulatedSession& simulated() {
  static const SimulatedSession s = [] {
    SimulationOptions options;
    options.duration_s = 9;  // 8 s are needed for the base to be tested for faults
    options.corner_sigma_px = kCornerSigma;
    return simulateSession(simulatedRig("euroc"), options);
  }();
  return s;
}

StudyInputs inputs(bool cameras_fixed) {
  StudyInputs in;
  in.session = &simulated().session;
  if (cameras_fixed) in.cameras = simulated().truth.cameras;
  in.cameras_fixed = cameras_fixed;
  in.camera.pixel_sigma = in.camera_imu.pixel_sigma = kCornerSigma;
  in.camera.cauchy_px = in.camera_imu.cauchy_px = 0;
  in.camera_imu.gravity_m_s2 = simulated().gravity_F.norm();
  return in;
}

PerturbationRecord study(bool cameras_fixed, const std::vector<Perturbation>& cases,
                         int threads = 2) {
  PerturbationStudyOptions options;
  options.threads = threads;
  auto record = perturbationStudy(inputs(cameras_fixed), cases, options);
  if (!record) throw std::runtime_error(toString(record.failure()));
  return std::move(record).value();
}

std::size_t indexOf(const PerturbationRecord& record, const std::string& name) {
  const auto found = std::find(record.parameters.begin(), record.parameters.end(), name);
  EXPECT_NE(found, record.parameters.end()) << name;
  return static_cast<std::size_t>(found - record.parameters.begin());
}

double largestChange(const PerturbationRecord& record, const PerturbationCase& c,
                     const std::string& but) {
  double largest = 0;
  for (std::size_t i = 0; i < c.changes_sigma.size(); ++i) {
    if (record.parameters[i] == but || !(record.base_std[i] > 0)) continue;
    largest = std::max(largest, std::abs(c.changes_sigma[i]));
  }
  return largest;
}

TEST(PerturbationStudy, RefusesOptionsOutOfRange) {
  EXPECT_THROW(study(true, {}, 0), InputError);
  PerturbationStudyOptions options;
  options.thresholds.change_sigma = {1, 0.1};
  EXPECT_THROW((void)perturbationStudy(inputs(true), {}, options), InputError)
      << "bad before caution";
}

TEST(PerturbationStudy, InjectedOffsetsComeBackAndNothingElseMoves) {
  const auto record =
      study(true, {{Kind::kImuShift, 100}, {Kind::kImuShift, -3.21}, {Kind::kImuShift, 0.0004}});
  for (const PerturbationCase& c : record.cases) {
    ASSERT_EQ(c.problem, "") << c.amount;
    EXPECT_EQ(c.frames, record.base.frames);
    EXPECT_LT(std::abs(c.offset_error_s), 1e-8) << c.amount;
    EXPECT_NEAR(c.time_offset_s - record.base.time_offset_s, 1e-3 * c.amount, 1e-8);
    EXPECT_LT(largestChange(record, c, "time_offset"), 0.01) << c.amount;
  }
  EXPECT_EQ(record.verdict.level, VerdictLevel::kGood);
}

// Offsets come back under exchanged cameras, too: the study says nothing of them.
TEST(PerturbationStudy, ABaseThatIsWrongIsNotGood) {
  StudyInputs in = inputs(true);
  std::swap(in.cameras[0].intrinsics, in.cameras[1].intrinsics);
  const auto record = perturbationStudy(in, {{Kind::kImuShift, 100}});
  ASSERT_TRUE(record) << record.failure();
  const auto& findings = record->verdict.findings;
  const auto base = std::ranges::find(findings, "Base calibration", &Finding::rule);
  ASSERT_NE(base, findings.end());
  EXPECT_NE(base->level, VerdictLevel::kGood);
  EXPECT_THAT(base->evidence, HasSubstr(": "));
  EXPECT_NE(record->verdict.level, VerdictLevel::kGood);
}

TEST(PerturbationStudy, ALargerTargetWidensTheBaselineInProportion) {
  const auto record = study(false, {{Kind::kTargetSize, 0.5}});
  const PerturbationCase& c = record.cases[0];
  ASSERT_EQ(c.problem, "");
  const auto tx = indexOf(record, "T_C0C1.tx");
  EXPECT_NEAR(c.values[tx] / record.base.values[tx], 1.005, 1e-7);
  // A plane of another size, seen from as much further away, looks the same.
  EXPECT_LT(std::abs(c.changes_sigma[indexOf(record, "cam0.fu")]), 1e-3);
}

TEST(PerturbationStudy, ATargetOfImpossibleSizeIsRefusedAndKeptAsAFailure) {
  const auto record = study(false, {{Kind::kTargetSize, 100}});
  const std::string& problem = record.cases[0].problem;
  EXPECT_THAT(problem, HasSubstr("target"));
  EXPECT_EQ(problem.find(';'), std::string::npos) << "no cure of what was injected: " << problem;
  EXPECT_EQ(record.verdict.level, VerdictLevel::kBad);  // of a study of this case alone
  EXPECT_THAT(record.verdict.findings.back().evidence, HasSubstr("0 of 1"));
}

TEST(PerturbationStudy, NoisierDensitiesWidenTheDeviations) {
  const auto record = study(true, {{Kind::kNoiseDensities, 1}, {Kind::kNoiseDensities, 4}});
  EXPECT_LT(largestChange(record, record.cases[0], ""), 1e-6);
  EXPECT_EQ(record.cases[0].time_offset_std_s, record.base.time_offset_std_s);
  EXPECT_GT(*record.cases[1].time_offset_std_s, 1.5 * *record.base.time_offset_std_s);
}

TEST(PerturbationStudy, AnotherStartEndsInTheSameMinimum) {
  const auto record =
      study(false, {{Kind::kInitialIntrinsics, 10}, {Kind::kInitialIntrinsics, -10}});
  for (const PerturbationCase& c : record.cases) {
    ASSERT_EQ(c.problem, "") << c.amount;
    EXPECT_LT(largestChange(record, c, ""), 1e-3) << c.amount;
  }
}

TEST(PerturbationStudy, HalfOfTheFramesGiveTheSameWithinTheirNoise) {
  const auto record = study(false, {{Kind::kDroppedFrames, 50, 1}});
  const PerturbationCase& c = record.cases[0];
  ASSERT_EQ(c.problem, "");
  EXPECT_NEAR(c.frames, 0.5 * record.base.frames, 0.15 * record.base.frames);
  // Half of the information: the change has the base's own deviation, and there are 30 of them.
  EXPECT_GT(largestChange(record, c, ""), 0.1);
  EXPECT_LT(largestChange(record, c, ""), 4.5);
}

TEST(PerturbationStudy, MissingImuSamplesAreBridged) {
  const auto record = study(true, {{Kind::kDroppedImu, 5, 1}});
  const PerturbationCase& c = record.cases[0];
  ASSERT_EQ(c.problem, "");
  EXPECT_LT(largestChange(record, c, ""), 4.5);
}

TEST(PerturbationStudy, AddedCornerNoiseShowsInTheRmse) {
  const auto record = study(false, {{Kind::kCornerNoise, 0.5, 1}, {Kind::kCornerNoise, 0.5, 2}});
  const double expected = std::sqrt(2 * (0.2 * 0.2 + 0.5 * 0.5));
  for (const PerturbationCase& c : record.cases) EXPECT_NEAR(c.rmse_px, expected, 0.03 * expected);
  EXPECT_NE(record.cases[0].values, record.cases[1].values);
  // Held against the noise that the study assumes, three deviations of it and more of many changes.
  const auto changes = static_cast<double>(2 * record.parameters.size());
  const auto& findings = record.verdict.findings;
  const auto noise = std::find_if(findings.begin(), findings.end(), [](const Finding& f) {
    return f.rule == "Parameters under corner-noise";
  });
  ASSERT_NE(noise, findings.end());
  EXPECT_NEAR(noise->threshold, std::sqrt(9 + 2 * std::log(changes)) * 0.5 / kCornerSigma, 1e-12);
}

TEST(PerturbationStudy, DeviationsHoldWhatTheCamerasLeaveOpen) {
  SimulationOptions simulation;
  simulation.duration_s = 10;
  simulation.camera_rate_hz = 10;
  simulation.corner_sigma_px = kCornerSigma;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), simulation);
  const auto stdOf = [&](bool cameras_fixed) {
    StudyInputs in = inputs(cameras_fixed);
    in.session = &s.session;
    const auto record = perturbationStudy(in, {{Kind::kNoiseDensities, 1}});
    EXPECT_TRUE(record.ok());
    // Of the base's cameras as well, where a case leaves them alone.
    const double of_base = *record->base.time_offset_std_s;
    EXPECT_NEAR(*record->cases[0].time_offset_std_s, of_base, 1e-9 * of_base);
    return record->base_std[indexOf(*record, "T_SC0.rx")];
  };
  EXPECT_GT(stdOf(false), 2 * stdOf(true));
}

TEST(PerturbationStudy, DoesNotDependOnThreads) {
  const std::vector<Perturbation> cases{{Kind::kImuShift, 10},
                                        {Kind::kCornerNoise, 0.1, 1},
                                        {Kind::kDroppedImu, 5, 1},
                                        {Kind::kImuShift, -10}};
  EXPECT_EQ(documentOf(study(true, cases, 1)), documentOf(study(true, cases, 3)));
}

TEST(PerturbationStudy, SaysWhatASessionCannotGive) {
  Session blind = simulated().session;
  blind.imu.reset();
  blind.cameras[1].name = "cam2";  // as of --only cam0,cam2
  StudyInputs in = inputs(false);
  in.session = &blind;
  const auto said = [](const StudyInputs& of, const Perturbation& p) -> std::string {
    try {
      (void)perturbationStudy(of, {p});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  // In the words of who asked.
  EXPECT_THAT(said(in, {Kind::kImuShift, 1}), StartsWith("imu-shift needs an IMU"));
  EXPECT_THAT(said(in, {Kind::kImuShift, 1, 0, "--offsets-ms"}),
              StartsWith("--offsets-ms needs an IMU, and the session has none"));
  EXPECT_THAT(said(inputs(true), {Kind::kInitialIntrinsics, 1, 0, "--initial-focal-percent"}),
              StartsWith("--initial-focal-percent changes the start"));
  const auto cameras_only = perturbationStudy(in, {{Kind::kCornerNoise, 0.1, 1}});
  ASSERT_TRUE(cameras_only);
  EXPECT_EQ(cameras_only->cases[0].problem, "");
  ASSERT_EQ(cameras_only->parameters.size(), 8u + 8 + 6);
  EXPECT_EQ(cameras_only->parameters[8], "cam2.fu");
  // No offset is nothing, not 0.
  EXPECT_THAT(perturbationTable(*cameras_only),
              ContainsRegex("base,0,,,yes,[^,]+,[^,]+,[^,]+,,,,,"));
  EXPECT_THAT(perturbationSummary(*cameras_only), Not(HasSubstr("0.000000")));
}

PerturbationCase shift(double amount_ms, double error_s, const std::string& problem = "") {
  PerturbationCase c;
  c.kind = "imu-shift";
  c.unit = "ms";
  c.amount = amount_ms;
  c.offset_error_s = error_s;
  c.problem = problem;
  return c;
}

TEST(TestedOffsets, AreSaidWithTheNearestThatWereNotRecovered) {
  PerturbationRecord record;
  record.cases = {shift(-300, 0), shift(-200, 0.2), shift(-100, 1e-7),
                  shift(100, 0),  shift(200, 0),    shift(300, 0, "did not converge")};
  const TestedOffsets tested = testedOffsets(record, 1e-3);
  EXPECT_EQ(tested.from_ms, -300);
  EXPECT_EQ(tested.to_ms, 300);
  EXPECT_EQ(tested.count, 6u);
  EXPECT_EQ(tested.recovered, 4u);
  EXPECT_EQ(tested.lost_below_ms, -200);
  EXPECT_EQ(tested.lost_above_ms, 300);
  EXPECT_THAT(perturbationFindings(record, {}).front().evidence,
              HasSubstr("within 1 ms: 4 of 6 tested between -300 and +300 ms; nearest to zero of "
                        "the others: -200 and +300 ms"));
}

TEST(TestedOffsets, ZeroIsNoneOfThemUnlessItWasTested) {
  PerturbationRecord record;
  record.cases = {shift(100, 0), shift(10, 0)};
  const std::string evidence = perturbationFindings(record, {}).front().evidence;
  EXPECT_THAT(evidence, HasSubstr("within 1 ms: all 2 tested between +10 and +100 ms"));
  EXPECT_THAT(evidence, Not(HasSubstr("nearest")));
}

// One point has no worst, no range and no slope.
TEST(TestedOffsets, ASingleOneIsSaidByItselfAlone) {
  PerturbationRecord record;
  record.cases = {shift(10, 3e-7)};
  const Finding good = perturbationFindings(record, {}).front();
  EXPECT_EQ(good.evidence,
            "the only one tested, +10 ms, is recovered to 0.3 us (recovered - injected - base)");
  EXPECT_EQ(good.level, VerdictLevel::kGood);
  record.cases = {shift(-300, 0.2)};
  const Finding lost = perturbationFindings(record, {}).front();
  EXPECT_EQ(lost.level, VerdictLevel::kBad);
  EXPECT_THAT(lost.evidence, StartsWith("the only one tested, -300 ms, is recovered to 200 ms"));
  EXPECT_THAT(lost.advice, HasSubstr("the cause was not tested"));
  for (const std::string& text : {perturbationSummary(record), documentOf(record)}) {
    for (const char* claim : {"worst", "between", "range", "slope", "nearest"}) {
      EXPECT_THAT(text, Not(HasSubstr(claim)));
    }
  }
}

TEST(TestedOffsets, ASingleOneThatFailedIsNoFindingOnOffsets) {
  PerturbationRecord record;
  record.cases = {shift(300, 0, "did not converge")};
  const auto findings = perturbationFindings(record, {});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].level, VerdictLevel::kBad);
  EXPECT_THAT(findings[0].evidence, HasSubstr("0 of 1 cases were solved; the first that failed, "
                                              "imu-shift +300 ms: did not converge"));
}

TEST(PerturbationSummary, AFactorHasNoSignThatAdds) {
  PerturbationCase c;
  c.kind = "noise-densities";
  c.amount = 0.5;
  c.unit = "x";
  EXPECT_EQ(amountText(c), "x0.5");
  c.amount = 10;
  c.unit = "ms";
  EXPECT_EQ(amountText(c), "+10 ms");
}

TEST(PerturbationTable, HasNoFiguresOfAFailedCase) {
  PerturbationRecord record;
  record.cases = {shift(300, 0, "did not converge")};
  EXPECT_THAT(perturbationTable(record), HasSubstr("imu-shift,300,ms,,no,,,,,,,did not converge"));
}

}  // namespace
}  // namespace plumbline
