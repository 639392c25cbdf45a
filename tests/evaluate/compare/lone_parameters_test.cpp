// SPDX-License-Identifier: BSD-3-Clause
// Which of several calibrations is the outlier, and when none is.
#include "evaluate/compare/lone_parameters.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/compare/findings.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// One parameter under calibrations a, b, c, ... with one standard deviation each.
ComparisonRecord comparison(const std::vector<double>& values, double std) {
  ComparisonRecord record;
  ComparedParameter p{"T_SC0.tx", "m", {}, {}, {}, {}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    record.calibrations.emplace_back().label = std::string(1, static_cast<char>('a' + i));
    p.values.emplace_back(values[i]);
    p.std.emplace_back(std);
    p.difference.push_back(i == 0 ? std::nullopt : std::optional(values[i] - values[0]));
    p.significance.push_back(p.difference.back());
  }
  record.parameters = {p};
  return record;
}

TEST(LoneParameters, NameTheOneThatIsFarFromAllOthers) {
  const auto lone = loneParameters(comparison({0.010, 0.011, 0.018}, 0.001));
  ASSERT_THAT(lone, SizeIs(1));
  EXPECT_EQ(lone[0].calibration, 2U);
  EXPECT_EQ(lone[0].name, "T_SC0.tx");
  EXPECT_NEAR(lone[0].sigmas, 7 / std::sqrt(2), 1e-9);  // from b, the nearer one
  EXPECT_NEAR(lone[0].others, 1 / std::sqrt(2), 1e-9);
}

TEST(LoneParameters, TheFirstCanBeIt) {
  const auto lone = loneParameters(comparison({0.018, 0.011, 0.010}, 0.001));
  ASSERT_THAT(lone, SizeIs(1));
  EXPECT_EQ(lone[0].calibration, 0U);
}

TEST(LoneParameters, OfTwoNeitherIs) {
  EXPECT_THAT(loneParameters(comparison({0.010, 0.018}, 0.001)), IsEmpty());
}

TEST(LoneParameters, NoneIsWhereTheOthersDisagreeOrTheDifferenceIsNotSignificant) {
  EXPECT_THAT(loneParameters(comparison({0.000, 0.009, 0.018}, 0.001)), IsEmpty());
  EXPECT_THAT(loneParameters(comparison({0.010, 0.011, 0.018}, 0.002)), IsEmpty());
}

TEST(LoneParameters, CalibrationsWithoutADeviationHaveNoSay) {
  ComparisonRecord record = comparison({0.010, 0.011, 0.018, 0.05}, 0.001);
  record.parameters[0].std[3].reset();
  const auto lone = loneParameters(record);
  ASSERT_THAT(lone, SizeIs(1));
  EXPECT_EQ(lone[0].calibration, 2U);
  record.parameters[0].std[0].reset();  // what the differences refer to
  EXPECT_THAT(loneParameters(record), IsEmpty());
}

TEST(LoneParameters, AreFoundAndSaid) {
  const ComparisonRecord record = comparison({0.010, 0.011, 0.018}, 0.001);
  const auto findings = loneFindings(record);
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].level, VerdictLevel::kCaution);
  EXPECT_THAT(findings[0].evidence, HasSubstr("c is the outlier"));
  EXPECT_THAT(findings[0].evidence, HasSubstr("T_SC0.tx (4.9)"));
  EXPECT_THAT(comparisonHeadline(record), HasSubstr("c is the outlier"));
  EXPECT_THAT(comparisonHeadline(comparison({0.010, 0.011, 0.012}, 0.001)),
              Not(HasSubstr("outlier")));
}

// Two with one mistake, such as the size of their common board, against one without.
TEST(LoneParameters, AMajorityIsNoProofWhereTheRecordingContradictsIt) {
  ComparisonRecord record = comparison({0.010, 0.011, 0.018}, 0.001);
  record.calibrations[0].contradicted = true;
  record.calibrations[2].contradicted = false;
  EXPECT_THAT(loneFindings(record)[0].evidence, Not(HasSubstr("contradicts")));
  record.calibrations[1].contradicted = true;
  EXPECT_THAT(loneFindings(record)[0].evidence,
              HasSubstr("the recording contradicts each of them, and not c"));
  EXPECT_THAT(loneFindings(record)[0].advice, HasSubstr("what the others share"));
  record.calibrations[2].contradicted = true;
  EXPECT_THAT(loneFindings(record)[0].evidence, Not(HasSubstr("contradicts")));
}

/// Two calibrations, a and b, and what the session itself gives.
ComparisonRecord onSession(double a, double b, double session, bool a_held_out, bool b_held_out) {
  ComparisonRecord record = comparison({a, b}, 0.001);
  record.session_estimate.emplace();
  record.session_estimate->parameters = comparison({session, a, b}, 0.001).parameters;
  for (const bool held_out : {a_held_out, b_held_out}) {
    CalibrationScore& score = record.scores.emplace_back();
    score.label = record.calibrations[record.scores.size() - 1].label;
    score.held_out = held_out;
  }
  return record;
}

TEST(LoneAgainstSession, OfTwoTheSessionTellsWhichIsOff) {
  const ComparisonRecord record = onSession(0.010, 0.018, 0.0101, true, true);
  const auto lone = loneAgainstSession(record);
  ASSERT_THAT(lone, SizeIs(1));
  EXPECT_EQ(lone[0].calibration, 1U);
  EXPECT_NEAR(lone[0].sigmas, 7.9 / std::sqrt(2), 1e-9);
  EXPECT_THAT(comparisonHeadline(record), HasSubstr("b is the outlier"));
  const auto findings = loneFindings(record);
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_THAT(findings[0].rule, HasSubstr("the session itself"));
}

TEST(LoneAgainstSession, AnEstimateFromTheSameSessionIsNoWitness) {
  // a agrees with the session because it comes from it; nothing is said of b.
  EXPECT_THAT(loneAgainstSession(onSession(0.010, 0.018, 0.0101, false, true)), IsEmpty());
  // b is the outlier although a's agreement counts: b's own origin does not matter.
  EXPECT_THAT(loneAgainstSession(onSession(0.010, 0.018, 0.0101, true, false)), SizeIs(1));
}

TEST(LoneAgainstSession, ASessionThatDiffersFromBothNamesNeither) {
  EXPECT_THAT(loneAgainstSession(onSession(0.010, 0.0101, 0.018, true, true)), IsEmpty());
}

}  // namespace
}  // namespace plumbline
