// SPDX-License-Identifier: BSD-3-Clause
// Changes under perturbations are held against what first order predicts from the estimate's
// deviations: sqrt(q / (1 - q)) of them for a share q of the data left out, s / sigma for corner
// noise s that is added, none for what the estimate should not depend on.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/studies/perturbation_study.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using Kind = PerturbationKind;

constexpr double kSigma = 0.2;  // [px], assumed of the corners

/// A study of one case, under which the lever arm moves by so many of its deviations.
Finding findingOf(Kind kind, double amount, double moved_sigma) {
  PerturbationRecord record;
  record.assumptions.pixel_sigma_px = kSigma;
  record.parameters = {"T_SC0.tx"};
  record.base_std = {1e-3};
  PerturbationCase c;
  c.kind = toString(kind);
  c.amount = amount;
  c.changes = {1e-3 * moved_sigma};
  c.changes_sigma = {moved_sigma};
  record.cases = {c};
  const auto findings = perturbationFindings(record, {});
  const auto found = std::find_if(findings.begin(), findings.end(), [](const Finding& f) {
    return f.rule.find("Parameters under") != std::string::npos;
  });
  EXPECT_NE(found, findings.end());
  return *found;
}

TEST(PerturbationFindings, DensitiesMustNotMoveTheEstimate) {
  const Finding f = findingOf(Kind::kNoiseDensities, 5, 13);
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
  EXPECT_EQ(f.value, 13);
  EXPECT_EQ(f.threshold, PerturbationThresholds{}.change_sigma.caution);
  EXPECT_THAT(f.evidence, HasSubstr("T_SC0.tx by 13 of its standard deviation"));
  EXPECT_THAT(f.advice, HasSubstr("imu.yaml"));
  EXPECT_EQ(findingOf(Kind::kNoiseDensities, 5, 0.05).level, VerdictLevel::kGood);
}

TEST(PerturbationFindings, FewerFramesMayMoveItByWhatTheyAreFewer) {
  EXPECT_NEAR(findingOf(Kind::kDroppedFrames, 50, 2.9).threshold, 3 * 1, 1e-12);
  EXPECT_EQ(findingOf(Kind::kDroppedFrames, 50, 2.9).level, VerdictLevel::kGood);
  EXPECT_EQ(findingOf(Kind::kDroppedFrames, 50, 3.1).level, VerdictLevel::kCaution);
  EXPECT_THAT(findingOf(Kind::kDroppedFrames, 50, 3.1).evidence,
              HasSubstr("predicts 1 (one sigma)"));
  EXPECT_NEAR(findingOf(Kind::kDroppedFrames, 90, 8).threshold, 3 * 3, 1e-12);
  EXPECT_NEAR(findingOf(Kind::kDroppedImu, 80, 4).threshold, 3 * 2, 1e-12);
  EXPECT_EQ(findingOf(Kind::kDroppedImu, 80, -6.5).level, VerdictLevel::kCaution);
}

TEST(PerturbationFindings, TheLargestOfManyChangesMayBeLarger) {
  PerturbationRecord record;
  record.assumptions.pixel_sigma_px = 1;
  record.parameters.assign(29, "T_SC0.tx");
  PerturbationCase c;
  c.kind = toString(Kind::kCornerNoise);
  c.amount = 0.5;
  c.unit = "px";
  c.changes.assign(29, 1e-3);
  c.changes_sigma.assign(29, 1.9);
  record.cases.assign(20, c);
  const auto levelOf = [&] { return perturbationFindings(record, {}).front().level; };
  // 3.8 predicted deviations are the largest of 580 in one study in twelve.
  EXPECT_EQ(levelOf(), VerdictLevel::kGood);
  c.changes_sigma = {1.9};
  record.cases = {c};
  EXPECT_EQ(levelOf(), VerdictLevel::kCaution);
}

// It comes back by definition, and nothing else can move.
TEST(PerturbationFindings, AnOffsetOfZeroTestsNothing) {
  PerturbationRecord record;
  record.parameters = {"T_SC0.tx"};
  PerturbationCase c;
  c.kind = toString(Kind::kImuShift);
  c.changes = c.changes_sigma = {0};
  record.cases = {c};
  const auto findings = perturbationFindings(record, {});
  ASSERT_EQ(findings.size(), 2U);  // with that on solved cases
  EXPECT_EQ(findings[0].level, VerdictLevel::kCaution);
  EXPECT_THAT(findings[0].evidence, HasSubstr("not tested"));
  record.cases[0].amount = 10;
  EXPECT_EQ(perturbationFindings(record, {})[0].level, VerdictLevel::kGood);
}

TEST(PerturbationFindings, AStudyWithoutASolvedCaseIsBad) {
  PerturbationRecord record;
  PerturbationCase failed, solved;
  failed.kind = solved.kind = toString(Kind::kImuShift);
  failed.amount = solved.amount = 10;
  failed.problem = "no solution";
  record.cases = {failed, failed};
  EXPECT_EQ(perturbationFindings(record, {}).back().level, VerdictLevel::kBad);
  record.cases = {failed, solved};
  EXPECT_EQ(perturbationFindings(record, {}).back().level, VerdictLevel::kCaution);
}

TEST(PerturbationFindings, AddedCornerNoiseMayMoveItByItsShareOfTheOwn) {
  const Finding f = findingOf(Kind::kCornerNoise, 0.5, 7);
  EXPECT_NEAR(f.threshold, 3 * 0.5 / kSigma, 1e-12);
  EXPECT_EQ(f.level, VerdictLevel::kGood);
  EXPECT_EQ(findingOf(Kind::kCornerNoise, 0.5, 8).level, VerdictLevel::kCaution);
}

}  // namespace
}  // namespace plumbline
