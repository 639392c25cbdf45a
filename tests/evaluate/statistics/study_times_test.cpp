// SPDX-License-Identifier: BSD-3-Clause
// How long participants took, and who gave up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/statistics/study_statistics.h"
#include "tests/evaluate/statistics/made_up_studies.h"

namespace plumbline {
namespace {

using test::effectOn;
using test::study;
using ::testing::HasSubstr;

TEST(StudyStatistics, TheTimeToFinishIsHeldAgainstItsInterval) {
  StudyTimeDifference t;
  t.baseline = "free";
  t.method = "guided";
  t.design = StudyDesign::kCrossover;
  t.participants = 9;
  t.p = 0.04;
  const auto sentence = [&](double low, double high) {
    t.difference_s = {0.5 * (low + high), low, high};
    return timeSentence(t, 120);
  };
  EXPECT_EQ(sentence(1, 21),
            "guided takes 11 s more than free on average up to 120 s, 95 % interval of the "
            "difference +1 to +21 s (p = 0.04; 9 participants)");
  EXPECT_EQ(sentence(-7, 21),
            "time to finish: guided and free were not shown to differ; guided takes 7 s more on "
            "average up to 120 s, 95 % interval of the difference -7 to +21 s (p = 0.04; 9 "
            "participants)");
  EXPECT_THAT(sentence(-21, 0), HasSubstr("were not shown to differ"));
  EXPECT_THAT(sentence(-21, -1), HasSubstr("guided takes 11 s less than free"));
  t.difference_s = {21, {}, {}};
  EXPECT_THAT(timeSentence(t, 120),
              HasSubstr("were not shown to differ; guided takes 21 s more on average up to 120 s, "
                        "no 95 % interval with so few participants"));
  t.design = StudyDesign::kOneOrder;
  t.p.reset();
  EXPECT_THAT(timeSentence(t, 120), HasSubstr("guided takes 21 s more than free"));
}

TEST(StudyStatistics, CountWhoGaveUpAsUnfinishedAtTheLimit) {
  StudyRecord record = study(8);
  record.limit_s = 300;
  for (StudySession& s : record.sessions) {
    if (s.name == "p1_guided") s.finished = false, s.capture_s = 20;
  }
  addStatistics(record);
  const StudySurvival& guided = record.statistics.survival[1];
  EXPECT_EQ(guided.participants, 8);
  EXPECT_EQ(guided.finished, 7);
  double mean = 300;
  for (const int i : {0, 2, 3, 4, 5, 6, 7}) mean += 1.2 * (60 + 5 * i);
  EXPECT_NEAR(guided.restricted_mean_s, mean / 8, 1e-9);
  const StudyTimeDifference& time = record.statistics.time[0];
  EXPECT_NEAR(time.difference_s.estimate,
              guided.restricted_mean_s - record.statistics.survival[0].restricted_mean_s, 1e-9);
  EXPECT_DOUBLE_EQ(*time.p, 2.0 / 70) << "all were slower with the guide: 8 over 4 orders";
}

// Nobody is faster with the guide, but nine of ten had it second, where all are faster.
TEST(StudyStatistics, TakeThePeriodOutOfTheTimeToFinish) {
  StudyRecord record = study(10);
  for (std::size_t i = 0; i < record.sessions.size(); ++i) {
    StudySession& s = record.sessions[i];
    if (s.participant != "p1") s.period = s.method == "guided" ? 2 : 1;
    s.capture_s = (s.period == 2 ? 50.0 : 60.0) + static_cast<double>(i / 2 % 3);
  }
  addStatistics(record);
  EXPECT_NEAR(record.statistics.time[0].difference_s.estimate, 0, 1e-9);
}

TEST(StudyStatistics, GivingUpIsNoBetterThanTakingLonger) {
  StudyRecord gave_up = study(8), longer = study(8);
  gave_up.limit_s = longer.limit_s = 300;
  for (std::size_t i = 0; i < longer.sessions.size(); ++i) {
    if (longer.sessions[i].name != "p1_guided") continue;
    gave_up.sessions[i].finished = false;
    longer.sessions[i].capture_s = 900;
  }
  addStatistics(gave_up);
  addStatistics(longer);
  EXPECT_EQ(effectOn(gave_up, "capture_s").effect.estimate,
            effectOn(longer, "capture_s").effect.estimate);
}

// Nobody stopped the time of who gave up: it counts all the same, everywhere alike.
TEST(StudyStatistics, CountWhoGaveUpWithoutATimeAtTheLimit) {
  StudyRecord timed = study(8), record = study(8);
  timed.limit_s = record.limit_s = 300;
  for (std::size_t i = 0; i < record.sessions.size(); ++i) {
    if (record.sessions[i].name != "p1_guided") continue;
    timed.sessions[i].finished = record.sessions[i].finished = false;
    record.sessions[i].capture_s.reset();
  }
  addStatistics(timed);
  addStatistics(record);
  EXPECT_EQ(record.statistics.survival[1].participants, 8);
  EXPECT_EQ(record.statistics.survival[1].restricted_mean_s,
            timed.statistics.survival[1].restricted_mean_s);
  EXPECT_EQ(record.statistics.time[0].difference_s.estimate,
            timed.statistics.time[0].difference_s.estimate);
  EXPECT_EQ(record.statistics.methods[1].median_capture_s,
            timed.statistics.methods[1].median_capture_s);
  for (StudySession& s : record.sessions) s.capture_s.reset();
  addStatistics(record);
  EXPECT_EQ(record.statistics.survival[1].participants, 0) << "a study without times";
}

TEST(StudyStatistics, CountParticipantsAndNotTheirSessions) {
  StudyRecord record = study(8);
  for (StudySession& s : record.sessions) {
    if (s.participant == "p1") s.finished = false;
  }
  StudySession again = record.sessions[0];
  again.name += "_again";
  record.sessions.push_back(again);
  addStatistics(record);
  EXPECT_THAT(record.statistics.sentences.back(), HasSubstr("participants who gave up: 1"));
  EXPECT_EQ(record.statistics.survival[0].participants, 8);
  EXPECT_EQ(record.statistics.survival[0].finished, 7);
}

// p0's second session is no other participant: the curve is over their mean times.
TEST(StudyStatistics, HaveCurvesOverParticipantsMeanTimes) {
  StudyRecord record = study(8);
  record.limit_s = 300;
  StudySession again = record.sessions[0];
  again.name += "_again";
  again.capture_s = *again.capture_s + 20;
  record.sessions.push_back(again);
  addStatistics(record);
  const StudySurvival& free = record.statistics.survival[0];
  ASSERT_EQ(free.curve.size(), 7u) << "p0's mean is p2's time";
  EXPECT_EQ(free.curve[0].at_risk, 8);
  EXPECT_NEAR(free.restricted_mean_s, (60 + 10 + 65 + 70 + 75 + 80 + 85 + 90 + 95) / 8.0, 1e-9);
  record.sessions.back().finished = false;  // and the other one was finished
  addStatistics(record);
  EXPECT_EQ(record.statistics.survival[0].finished, 8);
  EXPECT_NEAR(record.statistics.survival[0].restricted_mean_s,
              (0.5 * (60 + 300) + 65 + 70 + 75 + 80 + 85 + 90 + 95) / 8, 1e-9);
}

}  // namespace
}  // namespace plumbline
