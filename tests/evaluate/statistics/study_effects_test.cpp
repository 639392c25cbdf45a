// SPDX-License-Identifier: BSD-3-Clause
// Known effects are found in made-up studies, on the right scale, apart from the period; where
// nothing can be separated nothing is claimed.
#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "evaluate/statistics/study_statistics.h"
#include "report/records/documents.h"
#include "tests/evaluate/statistics/made_up_studies.h"

namespace plumbline {
namespace {

using test::effectOn;
using test::kEffect;
using test::kPeriod;
using test::study;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(StudyStatistics, FindTheMethodsEffectWithThePeriodTakenOut) {
  StudyRecord record = study(12);
  addStatistics(record);
  const StudyEffect& e = effectOn(record, "held_out_rmse_px");
  EXPECT_EQ(e.design, StudyDesign::kCrossover);
  EXPECT_TRUE(e.ratio);
  EXPECT_NEAR(e.effect.estimate, kEffect, 0.01);
  EXPECT_LT(*e.effect.low, kEffect);
  EXPECT_GT(*e.effect.high, kEffect);
  EXPECT_NEAR(e.period->estimate, kPeriod, 0.01);
  EXPECT_NEAR(e.bca->low.value(), *e.effect.low, 0.01);
  EXPECT_TRUE(e.exact);
  EXPECT_DOUBLE_EQ(e.permutations, 924);  // 12 over 6
  EXPECT_DOUBLE_EQ(*e.p, 2.0 / 924);      // nothing is more extreme, either way
  EXPECT_EQ(e.first_baseline, 6);
}

// An effect of the period alone must not become one of the method, whatever the order's balance.
TEST(StudyStatistics, TakeAPeriodForNoMethod) {
  StudyRecord record = study(13);
  for (StudySession& s : record.sessions) {
    if (s.method == "guided") *s.held_out_rmse_px /= kEffect;
    if (s.period == 2) *s.held_out_rmse_px *= 0.5;
  }
  addStatistics(record);
  const StudyEffect& e = effectOn(record, "held_out_rmse_px");
  EXPECT_NEAR(e.effect.estimate, 1, 0.015);
  EXPECT_NEAR(e.period->estimate, 0.5 * kPeriod, 0.01);
}

TEST(StudyStatistics, SayNoPValueOfTheMethodWhereAllHadOneOrder) {
  StudyRecord record = study(12, true);
  addStatistics(record);
  const StudyEffect& e = effectOn(record, "held_out_rmse_px");
  EXPECT_EQ(e.design, StudyDesign::kOneOrder);
  EXPECT_NEAR(e.effect.estimate, kEffect * kPeriod, 0.01);
  EXPECT_FALSE(e.p || e.p_holm || e.wilcoxon_p || e.period);
  EXPECT_THAT(e.sentence, HasSubstr("method and order are confounded"));
  EXPECT_THAT(e.sentence, Not(HasSubstr("p =")));
  EXPECT_FALSE(record.statistics.time[0].p);
}

/// Six participants with three methods, all in their order, or every second one in the opposite.
StudyRecord threeMethods(bool one_order) {
  StudyRecord record;
  record.methods = {"free", "dance", "guided"};
  record.endpoints = {"held_out_rmse_px"};
  for (int p = 0; p < 6; ++p) {
    for (int m = 0; m < 3; ++m) {
      StudySession s;
      s.participant = "p" + std::to_string(p);
      s.method = record.methods[static_cast<std::size_t>(m)];
      s.name = s.participant + s.method;
      s.period = one_order || p % 2 == 0 ? m + 1 : 3 - m;
      s.held_out_rmse_px = 0.3 - 0.05 * m + 0.001 * ((5 * p + 3 * m) % 7);
      record.sessions.push_back(s);
    }
  }
  return record;
}

TEST(StudyStatistics, SayNoPValueOfThreeMethodsInOneOrder) {
  StudyRecord same = threeMethods(true), both = threeMethods(false);
  addStatistics(same);
  addStatistics(both);
  ASSERT_FALSE(same.statistics.quade.empty());
  const StudyQuade& q = same.statistics.quade.front();
  EXPECT_FALSE(q.p.has_value());
  EXPECT_THAT(q.sentence, AllOf(HasSubstr("are confounded"), Not(HasSubstr("p ="))));
  ASSERT_TRUE(both.statistics.quade.front().p.has_value());
  EXPECT_LT(*both.statistics.quade.front().p, 0.01);
  EXPECT_DOUBLE_EQ(both.statistics.quade.front().statistic, q.statistic);
  StudyRecord one = threeMethods(true);
  for (int m = 0; m < 3; ++m) one.sessions[static_cast<std::size_t>(m)].period = 3 - m;
  addStatistics(one);
  EXPECT_FALSE(one.statistics.quade.front().p) << "one participant in the other order";
  EXPECT_THAT(one.statistics.quade.front().sentence, HasSubstr("orders are not balanced"));
}

// Those without a figure under all methods have no part in the test, nor in its balance.
TEST(StudyStatistics, BalanceOrdersOfThoseWhoCount) {
  const auto leaveOut = [](StudyRecord& record, std::size_t participant) {
    record.sessions[3 * participant + 2].held_out_rmse_px.reset();
  };
  StudyRecord skewed = threeMethods(false);  // 0, 2, 4 forth; 5 back
  leaveOut(skewed, 1);
  leaveOut(skewed, 3);
  addStatistics(skewed);
  ASSERT_FALSE(skewed.statistics.quade.empty());
  EXPECT_EQ(skewed.statistics.quade.front().participants, 4);
  EXPECT_FALSE(skewed.statistics.quade.front().p);
  StudyRecord evened = threeMethods(false);  // 0, 1, 2, 4 forth; 3, 5 back
  for (std::size_t m = 0; m < 3; ++m) evened.sessions[3 + m].period = static_cast<int>(m) + 1;
  leaveOut(evened, 1);
  addStatistics(evened);
  ASSERT_FALSE(evened.statistics.quade.empty());
  EXPECT_EQ(evened.statistics.quade.front().participants, 5);
  EXPECT_TRUE(evened.statistics.quade.front().p);
}

TEST(StudyStatistics, SpeakFirstOfTheDeclaredEndpoints) {
  StudyRecord record = study(12);
  addStatistics(record);
  EXPECT_EQ(record.statistics.sentences.front(), effectOn(record, "held_out_rmse_px").sentence);
  EXPECT_THAT(
      record.statistics.sentences.front(),
      ::testing::MatchesRegex("guided has 18 % lower held-out RMSE than free, 95 % interval "
                              "1[67] to (19|20) % \\(p = 0.0022, 0.0022 by Holm; 12 "
                              "participants\\)"));
}

TEST(StudyStatistics, ClaimNoDifferenceThatTheIntervalDoesNotShow) {
  StudyRecord record = study(12);
  int i = 0;
  for (StudySession& s : record.sessions) {  // the same spread under both methods, and no effect
    s.held_out_rmse_px = 0.2 * (1 + 0.01 * (3 * i++ % 7));
  }
  addStatistics(record);
  const StudyEffect& e = effectOn(record, "held_out_rmse_px");
  ASSERT_TRUE(e.effect.low && e.effect.high);
  ASSERT_TRUE(*e.effect.low < 1 && *e.effect.high > 1) << *e.effect.low << " " << *e.effect.high;
  EXPECT_THAT(e.sentence, HasSubstr("guided and free were not shown to differ; guided "));
}

// With ties an interval may end exactly at no change.
TEST(StudyStatistics, AnIntervalThatEndsAtNoChangeHoldsIt) {
  for (const bool ratio : {true, false}) {
    const double none = ratio ? 1 : 0;
    StudyEffect e;
    e.endpoint = "held_out_rmse_px";
    e.baseline = "free";
    e.method = "guided";
    e.design = StudyDesign::kCrossover;
    e.ratio = ratio;
    e.participants = 9;
    const auto sentence = [&](double low, double high) {
      e.effect = {none + 0.5 * (low + high), none + low, none + high};
      return effectSentence(e, "held-out RMSE");
    };
    EXPECT_THAT(sentence(0, 0.2), HasSubstr("were not shown to differ")) << ratio;
    EXPECT_THAT(sentence(-0.2, 0), HasSubstr("were not shown to differ")) << ratio;
    EXPECT_THAT(sentence(0.01, 0.2), Not(HasSubstr("were not shown to differ"))) << ratio;
    EXPECT_THAT(sentence(-0.2, -0.01), Not(HasSubstr("were not shown to differ"))) << ratio;
  }
}

TEST(StudyStatistics, CallDurationsAloneLonger) {
  StudyRecord record = study(12);
  for (StudySession& s : record.sessions) s.time_offset_std_s = s.method == "guided" ? 2e-4 : 1e-4;
  addStatistics(record);
  EXPECT_THAT(effectOn(record, "capture_s").sentence, HasSubstr("20 % longer capture time"));
  EXPECT_THAT(effectOn(record, "time_offset_std_s").sentence,
              HasSubstr("100 % higher standard deviation of the time offset"));
}

TEST(StudyStatistics, CorrectOverTheDeclaredEndpointsAlone) {
  StudyRecord record = study(12);
  record.endpoints = {"held_out_rmse_px", "capture_s"};
  addStatistics(record);
  const StudyEffect& e = effectOn(record, "held_out_rmse_px");
  EXPECT_DOUBLE_EQ(*e.p_holm, std::min(1.0, 2 * *e.p));
  record.endpoints = {"capture_s"};
  addStatistics(record);
  EXPECT_FALSE(effectOn(record, "held_out_rmse_px").p_holm);
  EXPECT_FALSE(effectOn(record, "held_out_rmse_px").declared);
}

TEST(StudyStatistics, LeaveOutParticipantsWithoutBothFigures) {
  StudyRecord record = study(12);
  record.sessions[3].held_out_rmse_px.reset();
  addStatistics(record);
  const StudyEffect& e = effectOn(record, "held_out_rmse_px");
  EXPECT_EQ(e.participants, 11);
  EXPECT_EQ(e.left_out, 1);
}

// The sequence that failed under one method is left out under the other as well.
TEST(StudyStatistics, AverageTheLogAteOverSequencesCompleteUnderBoth) {
  StudyRecord record = study(6);
  for (const StudySession& s : record.sessions) {
    const double factor = s.method == "guided" ? 0.5 : 1;
    record.trajectories.push_back({s.name, "easy", "0", 0.1 * factor, ""});
    const bool lost = s.name == "p2_guided";
    record.trajectories.push_back({s.name, "hard", "0",
                                   lost ? std::nullopt : std::optional(3 * factor),
                                   lost ? "diverged" : ""});
  }
  addStatistics(record);
  EXPECT_NEAR(effectOn(record, "ate_m").effect.estimate, 0.5, 1e-12);
}

// Positive in every session, and yet with a sign.
TEST(StudyStatistics, CompareEstimatesByDifferences) {
  StudyRecord record = study(6);
  for (StudySession& s : record.sessions) {
    s.estimates = {{"T_SC0.tx", s.method == "guided" ? 0.02 : 0.01, 1e-3, "m", {}, {}, {}}};
  }
  record.endpoints = {"estimates.T_SC0.tx"};
  addStatistics(record);
  const StudyEffect& e = effectOn(record, "estimates.T_SC0.tx");
  EXPECT_FALSE(e.ratio);
  EXPECT_NEAR(e.effect.estimate, 0.01, 1e-12);
}

TEST(StudyStatistics, ReachStagesByTheirNames) {
  StudyRecord record = study(6);
  for (StudySession& s : record.sessions) {
    s.stages = {{"camera", s.method == "guided" ? 20.0 : 40.0}, {"camera_imu", 30}};
  }
  record.endpoints = {"stages_s.camera", "nonsense"};
  addStatistics(record);
  EXPECT_NEAR(effectOn(record, "stages_s.camera").effect.estimate, 0.5, 1e-12);
  EXPECT_THAT(record.statistics.sentences.back(), HasSubstr("nonsense has no figure"));
}

TEST(StudyStatistics, UseQuadesTestForThreeMethods) {
  StudyRecord record = study(6);
  record.methods.push_back("other");
  for (int i = 0; i < 6; ++i) {
    StudySession s = record.sessions[static_cast<std::size_t>(2 * i)];
    s.method = "other";
    s.name = s.participant + "_other";
    s.period = i < 3 ? 3 : 0;  // after the other two, or before them
    *s.held_out_rmse_px *= 2;
    record.sessions.push_back(s);
  }
  addStatistics(record);
  ASSERT_FALSE(record.statistics.quade.empty());
  EXPECT_EQ(record.statistics.quade[0].participants, 6);
  EXPECT_LT(record.statistics.quade[0].p.value(), 0.01);
}

TEST(StudyStatistics, AreTheSameForTheSameRecord) {
  StudyRecord a = study(10), b = study(10);
  addStatistics(a);
  addStatistics(a);  // from the rest alone
  addStatistics(b);
  EXPECT_EQ(documentOf(a), documentOf(b));
}

// Equal but for their last digits: no sign may be read into them.
TEST(StudyStatistics, FindNothingInValuesThatDifferByTheirRounding) {
  StudyRecord record = study(12);
  for (StudySession& s : record.sessions) {
    s.time_offset_std_s = s.method == "guided" ? 7e-5 : std::nextafter(7e-5, 1);
  }
  addStatistics(record);
  EXPECT_DOUBLE_EQ(*effectOn(record, "time_offset_std_s").p, 1);
}

TEST(StudyStatistics, SayThatPairsAreTooFew) {
  StudyRecord record = study(1);
  addStatistics(record);
  EXPECT_EQ(effectOn(record, "held_out_rmse_px").design, StudyDesign::kTooFew);
  EXPECT_THAT(record.statistics.sentences.front(), HasSubstr("too few"));
  StudyRecord none;
  none.methods = {"free", "guided"};
  addStatistics(none);
  EXPECT_EQ(none.statistics.methods.size(), 2U);
}

}  // namespace
}  // namespace plumbline
