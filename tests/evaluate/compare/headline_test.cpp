// SPDX-License-Identifier: BSD-3-Clause
// What a comparison says first: "better" needs an interval without zero.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/compare/findings.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

// ours at 0.5 px on corners that it has not seen, kalibr beside it.
ComparisonRecord comparison(double difference_px2, double std_px2) {
  ComparisonRecord record;
  record.name = "session";
  for (const char* label : {"ours", "kalibr"}) {
    record.calibrations.emplace_back().label = label;
    CalibrationScore& score = record.scores.emplace_back();
    score.label = label;
    score.held_out = true;
    score.reprojection.count = 100;
    score.reprojection.rmse_px = 0.5;
  }
  for (const char* camera : {"cam0", "cam1"}) {
    PairedPrediction& p = record.paired.emplace_back();
    p.label = "kalibr";
    p.camera = camera;
    p.views = 50;
    p.difference_px2 = difference_px2;
    p.std_px2 = std_px2;
    p.blocks = 6;
    p.half_px2 = 2.570582 * std_px2;  // Student's t, 5 degrees of freedom
    p.first_px2 = 0.25;
  }
  return record;
}

TEST(ComparisonHeadline, SaysWhichPredictsBetterAndByHowMuch) {
  // sqrt(0.25 + 0.11) - 0.5 = 0.1 px, standard error 0.01 / sqrt(2) px^2 over both cameras with 10
  // degrees of freedom: +- 2.228 of them
  const std::string text = comparisonHeadline(comparison(0.11, 0.01));
  EXPECT_THAT(
      text,
      HasSubstr("ours predicts held-out corners better by 0.1 px RMSE, every view counting alike"));
  EXPECT_THAT(text, HasSubstr("95 % interval 0.087 to 0.11"));
}

TEST(ComparisonHeadline, TheOtherCanBeBetter) {
  EXPECT_THAT(
      comparisonHeadline(comparison(-0.11, 0.01)),
      HasSubstr(
          "kalibr predicts held-out corners better by 0.13 px RMSE, every view counting alike"));
}

TEST(ComparisonHeadline, AnIntervalWithZeroNamesNoWinner) {
  const std::string text = comparisonHeadline(comparison(0.01, 0.02));
  EXPECT_THAT(text, HasSubstr("predict held-out corners equally well within the 95 % interval"));
  EXPECT_THAT(text, Not(HasSubstr("better")));
}

TEST(ComparisonHeadline, WhoWasEstimatedFromTheCornersOnlyFitsThem) {
  ComparisonRecord record = comparison(0.11, 0.01);
  record.scores[0].held_out = false;
  record.scores[0].in_sample = true;
  EXPECT_THAT(comparisonHeadline(record),
              testing::AllOf(HasSubstr("ours fits the corners of session (ours was estimated from "
                                       "them) better by 0.1 px"),
                             HasSubstr("which says nothing of other recordings")));
}

// 1e-6 of 0.5 px, however certain: digits that one file has not.
TEST(ComparisonHeadline, ADifferenceOfNoConsequenceNamesNoWinner) {
  const ComparisonRecord record = comparison(4e-6, 1e-8);
  EXPECT_FALSE(record.paired[0].isClear());
  EXPECT_THAT(
      comparisonHeadline(record),
      testing::AllOf(HasSubstr("kalibr and ours predict held-out corners alike: their RMSE differ "
                               "by 4e-06 px at most"),
                     Not(HasSubstr("better"))));
}

// Within 1 % by chance is not shown to be alike.
TEST(ComparisonHeadline, ASmallDifferenceWithAWideIntervalIsNotCalledAlike) {
  EXPECT_THAT(comparisonHeadline(comparison(1e-3, 0.02)),
              HasSubstr("equally well within the 95 % interval"));
}

TEST(ComparisonHeadline, HeldOutIsWhatNeitherWasEstimatedFrom) {
  for (const std::size_t own : {0, 1}) {
    ComparisonRecord record = comparison(0.11, 0.01);
    record.scores[own].held_out = false;
    // Of the better one: the other may have seen the corners, and is worse all the same.
    const std::string verb = own == 0 ? "fits" : "predicts";
    EXPECT_THAT(
        comparisonHeadline(record),
        HasSubstr("ours " + verb + " the corners of session (not known to be held out) better"));
  }
}

TEST(ComparisonHeadline, NobodyIsBetterWithoutAnInterval) {
  ComparisonRecord record = comparison(0.11, 0.01);
  record.paired[1].blocks = 0;
  record.paired[1].std_px2 = record.paired[1].half_px2 = 0;
  EXPECT_THAT(comparisonHeadline(record), Not(HasSubstr("predict")));
}

TEST(ComparisonHeadline, NamesWhereProjectionsDifferMost) {
  ComparisonRecord record = comparison(0.11, 0.01);
  ImageMap& map = record.differences.emplace_back();
  map.label = "kalibr - ours";
  map.camera = "cam1";
  map.columns = 3;
  map.rows = 3;
  map.values = {1, 2, 22, 1, 0, 1, 3, 1, 2};
  EXPECT_THAT(comparisonHeadline(record),
              HasSubstr("they differ by up to 22 px at the top right of cam1"));
}

}  // namespace
}  // namespace plumbline
