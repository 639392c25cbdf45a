// SPDX-License-Identifier: BSD-3-Clause
// Sessions against the deviations that they state, by hand where these differ from session to
// session; and the figures of a method.
#include <cmath>

#include <gtest/gtest.h>

#include "evaluate/statistics/study_statistics.h"

namespace plumbline {
namespace {

StudySession sessionWith(const std::string& name, double value, double robust_std) {
  StudySession s;
  s.name = s.participant = name;
  s.method = "free";
  // The formal deviation is not the one that is shown.
  s.estimates = {{"cam0.fu", value, 7, "px", {}, robust_std, 10.0}};
  return s;
}

// Weights of 1, 1 and 1/4: the mean is (0 + 3 + 9 / 4) / (9 / 4) = 7/3, and chi^2 = (7/3)^2 +
// (2/3)^2 + (20/3 / 2)^2 = 17.
TEST(Spread, IsAboutTheMeanWeightedByTheShownDeviations) {
  StudyRecord record;
  record.methods = {"free"};
  record.sessions = {sessionWith("a", 0, 1), sessionWith("b", 3, 1), sessionWith("c", 9, 2)};
  StudySession failed = sessionWith("d", 1000, 1);
  failed.status = StudyStatus::kFailed;
  record.sessions.push_back(failed);
  const auto spread = spreadOverSessions(record);
  ASSERT_EQ(spread.size(), 1U);
  const StudySpread& s = spread[0];
  EXPECT_EQ(s.sessions, 3);
  EXPECT_NEAR(s.mean, 7.0 / 3, 1e-12);
  EXPECT_NEAR(s.ratio, std::sqrt(17.0 / 2), 1e-12);
  EXPECT_NEAR(s.std, std::sqrt(21.0), 1e-12) << "of three values about their own mean of 4";
  EXPECT_NEAR(s.stated_std, std::sqrt(2.0), 1e-12) << "the root of the mean variance";
  EXPECT_EQ(s.farthest, "c");
  record.sessions[0].estimates[0].value = -4;
  EXPECT_EQ(spreadOverSessions(record)[0].farthest, "a") << "by its deviation, not by its distance";
}

TEST(Spread, OfTwoSessionsIsNotJudged) {
  StudyRecord record;
  record.methods = {"free"};
  record.sessions = {sessionWith("a", 0, 1), sessionWith("b", 30, 1)};
  EXPECT_TRUE(spreadOverSessions(record).empty());
}

TEST(StudyMethod, CountsVerdictsAndScatterOfItsOwnSessions) {
  StudyRecord record;
  record.methods = {"free", "guided"};
  record.limit_s = 300;
  const std::optional<VerdictLevel> verdicts[] = {
      VerdictLevel::kGood, VerdictLevel::kCaution, VerdictLevel::kCaution, VerdictLevel::kBad, {}};
  for (int i = 0; i < 5; ++i) {
    StudySession s = sessionWith("p" + std::to_string(i), 0, 1);
    s.verdict = verdicts[i];
    s.capture_s = 10 * (i + 1);
    if (s.verdict) s.time_offset_s = 1e-3 * i;  // 0, 1, 2 and 3 ms
    if (!s.verdict) s.status = StudyStatus::kFailed;
    s.finished = i != 0;
    record.sessions.push_back(s);
  }
  record.sessions.push_back(sessionWith("q", 0, 1));
  record.sessions.back().method = "guided";
  addStatistics(record);
  const StudyMethod& m = record.statistics.methods[0];
  EXPECT_EQ(m.sessions, 5);
  EXPECT_EQ(m.calibrated, 4);
  EXPECT_EQ(m.gave_up, 1);
  EXPECT_EQ(m.good, 1);
  EXPECT_EQ(m.caution, 2);
  EXPECT_EQ(m.bad, 1);
  EXPECT_EQ(m.median_capture_s, 40) << "of 20, 30, 40, 50 s and the limit";
  EXPECT_NEAR(m.time_offset_mean_s.value(), 1.5e-3, 1e-15);
  EXPECT_NEAR(m.time_offset_std_s.value(), 1e-3 * std::sqrt(5.0 / 3), 1e-15);
}

}  // namespace
}  // namespace plumbline
