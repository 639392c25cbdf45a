// SPDX-License-Identifier: BSD-3-Clause
// Sessions against the deviations that they state, by hand where these differ from session to
// session; and the figures of a method.
#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
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

/// Values that scatter by their deviations exactly: +-1 sigma about the mean.
StudyRecord spreadStudy(double scatter) {
  StudyRecord record;
  record.methods = {"free"};
  for (int i = 0; i < 10; ++i) {
    StudySession s;
    s.name = s.participant = "p" + std::to_string(i);
    s.method = "free";
    const double sign = i % 2 == 0 ? 1 : -1;
    // A rotation by 120 degrees, so that Log's components are far from the tangent's.
    const Eigen::Vector3d w =
        logSO3(expSO3({0, 0, sign * scatter * 1e-3}) * expSO3({1.2, 1.2, 1.2}));
    s.estimates = {{"cam0.fu", 450 + sign * scatter * 0.1, 0.1, "px", {}, {}, {}},
                   {"T_SC0.rx", w.x(), 1e-3, "rad", {}, {}, {}},
                   {"T_SC0.ry", w.y(), 1e-3, "rad", {}, {}, {}},
                   {"T_SC0.rz", w.z(), 1e-3, "rad", {}, {}, {}}};
    record.sessions.push_back(s);
  }
  return record;
}

TEST(Spread, IsMeasuredInStatedDeviationsAndForRotationsInTheirTangent) {
  const auto spread = spreadOverSessions(spreadStudy(1));
  ASSERT_EQ(spread.size(), 4U);
  const double expected = std::sqrt(10.0 / 9);
  EXPECT_EQ(spread[3].parameter, "cam0.fu");
  EXPECT_NEAR(spread[3].ratio, expected, 1e-9);
  EXPECT_NEAR(spread[3].mean, 450, 1e-9);
  EXPECT_NEAR(spread[3].stated_std, 0.1, 1e-12);
  EXPECT_EQ(spread[2].parameter, "T_SC0.rz");
  EXPECT_NEAR(spread[2].ratio, expected, 1e-6);
  EXPECT_NEAR(spread[0].ratio, 0, 1e-6) << "nothing turned about x";
  // chi^2 of 9: 2.700 and 19.023.
  EXPECT_NEAR(spread[3].low, std::sqrt(2.700389 / 9), 1e-6);
  EXPECT_NEAR(spread[3].high, std::sqrt(19.022768 / 9), 1e-6);
}

// k1 is another quantity under another lens model.
TEST(Spread, KeepsLensModelsApart) {
  StudyRecord record = spreadStudy(1);
  for (std::size_t i = 0; i < record.sessions.size(); ++i) {
    const bool radtan = i < 6;
    for (const char* name : {"cam0.k1", radtan ? "cam0.p1" : "cam0.k3"}) {
      record.sessions[i].estimates.push_back({name, radtan ? -0.3 : 0.01, 1e-3, "-", {}, {}, {}});
    }
  }
  std::map<std::string, const StudySpread*> of;
  const auto spread = spreadOverSessions(record);
  for (const StudySpread& s : spread) of[s.parameter] = &s;
  ASSERT_TRUE(of.count("cam0.k1 (k1 p1)") && of.count("cam0.k1 (k1 k3)"));
  EXPECT_EQ(of["cam0.k1 (k1 p1)"]->sessions, 6);
  EXPECT_NEAR(of["cam0.k1 (k1 p1)"]->ratio, 0, 1e-9);
  EXPECT_EQ(of["cam0.fu (k1 k3)"]->sessions, 4);
  EXPECT_EQ(of["cam0.k3"]->sessions, 4) << "of one model alone";
  EXPECT_EQ(of["T_SC0.rx"]->sessions, 10) << "of no lens";
}

TEST(Spread, ThatIsLargerThanStatedIsSaid) {
  StudyRecord record = spreadStudy(3);
  addStatistics(record);
  EXPECT_THAT(record.statistics.sentences.front(), ::testing::HasSubstr("2 more, 2 less"));
}

}  // namespace
}  // namespace plumbline
