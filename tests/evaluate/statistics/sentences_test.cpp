// SPDX-License-Identifier: BSD-3-Clause
// The sentences say the direction, the size and the unit of the values that stand beside them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/statistics/study_statistics.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

StudyEffect effectOf(StudyDesign design, bool ratio, const StudyInterval& interval) {
  StudyEffect e;
  e.endpoint = ratio ? "held_out_rmse_px" : "compliance";
  e.unit = ratio ? "px" : "1";
  e.baseline = "free";
  e.method = "guided";
  e.design = design;
  e.ratio = ratio;
  e.participants = 12;
  e.effect = interval;
  if (design == StudyDesign::kCrossover) e.p = 0.3;
  return e;
}

TEST(Sentences, AnIntervalWithNoChangeInItHasADirectionAtEitherEnd) {
  const StudyEffect e = effectOf(StudyDesign::kCrossover, true, {0.95, 0.8, 1.06});
  EXPECT_THAT(effectSentence(e, "RMSE"),
              HasSubstr("guided 5 % lower, 95 % interval 20 % lower to 6 % higher (p = 0.3"));
}

TEST(Sentences, ASizeWithoutAUnitHasNone) {
  const StudyEffect e = effectOf(StudyDesign::kCrossover, false, {0.25, 0.125, 0.5});
  EXPECT_THAT(
      effectSentence(e, "compliance"),
      HasSubstr("guided has 0.25 higher compliance than free, 95 % interval 0.125 to 0.5 ("));
}

TEST(Sentences, OfOneOrderTheFirstMethodIsNamed) {
  StudyEffect e = effectOf(StudyDesign::kOneOrder, true, {0.8, 0.7, 0.9});
  e.first_baseline = 12;
  EXPECT_THAT(effectSentence(e, "RMSE"), HasSubstr("all began with free,"));
  e.first_baseline = 0;
  e.first_method = 12;
  EXPECT_THAT(effectSentence(e, "RMSE"), HasSubstr("all began with guided,"));
}

TEST(Sentences, QuadesTestShowsADifferenceUpToFivePerCent) {
  StudyQuade q{"held_out_rmse_px", 8, 4.5, 2, 14, 0.05};
  EXPECT_THAT(quadeSentence(q, "RMSE"), HasSubstr("the methods differ"));
  q.p = 0.051;
  EXPECT_THAT(quadeSentence(q, "RMSE"), HasSubstr("the methods were not shown to differ"));
}

TEST(Sentences, TheTimeToFinishIsLessWhereTheDifferenceIsBelowZero) {
  StudyTimeDifference t;
  t.baseline = "free";
  t.method = "guided";
  t.participants = 8;
  t.design = StudyDesign::kCrossover;
  t.p = 0.04;
  t.difference_s = {-12, -20, -4};
  EXPECT_EQ(timeSentence(t, 300),
            "guided takes 12 s less than free on average up to 300 s, 95 % interval of the "
            "difference -20 to -4 s (p = 0.04; 8 participants)");
  t.difference_s = {12, 4, 20};
  EXPECT_THAT(timeSentence(t, 300), HasSubstr("takes 12 s more than free"));
  t.p.reset();
  t.design = StudyDesign::kOneOrder;
  EXPECT_THAT(timeSentence(t, 300), Not(HasSubstr("p =")));
}

}  // namespace
}  // namespace plumbline
