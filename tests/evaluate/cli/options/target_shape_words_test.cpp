// SPDX-License-Identifier: BSD-3-Clause
// Words for the shape of a simulated board, against the places of its corners.
#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/options/simulation_options.h"

namespace plumbline {
namespace {

std::vector<Eigen::Vector3d> pointsOf(const std::string& words) {
  AprilGrid board;
  board.shape = targetShapeFromWords(words, board);
  return cornerPoints(board);
}

// Corner ids at the ends of a 6 x 6 grid.
constexpr int kBottomLeft = 0, kBottomRight = 4 * 5 + 1, kTopRight = 4 * 35 + 2,
              kTopLeft = 4 * 30 + 3, kMiddle = 4 * 14 + 2;

TEST(TargetShapeWords, ABowLiftsTheMiddleAboveTheCorners) {
  const auto p = pointsOf("bow=1mm");
  EXPECT_NEAR(p[kMiddle].z() - p[kBottomLeft].z(), 1e-3, 0.02e-3);
  EXPECT_NEAR(p[kTopRight].z(), p[kBottomLeft].z(), 1e-12);
}

TEST(TargetShapeWords, OnlyTheWordForItWidensTheTags) {
  const AprilGrid grid;
  EXPECT_EQ(targetShapeFromWords("bow=2mm,stretch=0.3%,shear=0.1%", grid).terms[kTargetTerms - 1],
            0);
  EXPECT_NEAR(targetShapeFromWords("tag-edge=0.1mm", grid).terms[kTargetTerms - 1], 1e-4, 1e-12);
}

TEST(TargetShapeWords, ATwistLiftsOppositeCorners) {
  const auto p = pointsOf("twist=0.5mm");
  EXPECT_NEAR(p[kTopRight].z() - p[kTopLeft].z(), 1e-3, 1e-9);
  EXPECT_NEAR(p[kTopRight].z(), p[kBottomLeft].z(), 1e-12);
}

TEST(TargetShapeWords, AStretchIsTheRatioOfTheSides) {
  const auto p = pointsOf("stretch=0.3%");
  const double width = (p[kBottomRight] - p[kBottomLeft]).norm();
  const double height = (p[kTopLeft] - p[kBottomLeft]).norm();
  EXPECT_NEAR(width / height, 1.003, 1e-5);
}

TEST(TargetShapeWords, AKeystoneIsWiderAtTheTop) {
  const auto p = pointsOf("keystone=0.2%");
  const double top = (p[kTopRight] - p[kTopLeft]).norm();
  const double bottom = (p[kBottomRight] - p[kBottomLeft]).norm();
  EXPECT_NEAR(top / bottom, 1.002, 1e-5);
}

TEST(TargetShapeWords, AnSBendIsOddAndOfDegreeThree) {
  const AprilGrid grid;
  const TargetShape shape = targetShapeFromWords("s-bend=0.2mm", grid);
  ASSERT_TRUE(shape.higher);
  EXPECT_LT(shape.terms.cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(shape.higher->head<2 * kHigherFunctions>().cwiseAbs().maxCoeff(), 1e-12);
  const auto p = pointsOf("s-bend=0.2mm");
  // 1.5 sqrt(3) 0.2 mm of x^3 in units of half the width, less the plane that fits best.
  EXPECT_NEAR(p[kBottomRight].z(), -p[kBottomLeft].z(), 1e-12);
  EXPECT_NEAR(p[kTopRight].z(), p[kBottomRight].z(), 1e-12);
  EXPECT_GT(p[kBottomLeft].z() - p[kBottomRight].z(), 0.2e-3);
  EXPECT_FALSE(targetShapeFromWords("bow=1mm,tag-edge=0.1mm", grid).higher);
}

TEST(TargetShapeWords, WordsAddUp) {
  const AprilGrid grid;
  const auto sum = targetShapeFromWords("bow=1mm,stretch=0.3%,tag-edge=-0.2mm", grid).terms;
  const auto parts = targetShapeFromWords("bow=1mm", grid).terms +
                     targetShapeFromWords("stretch=0.3%", grid).terms +
                     targetShapeFromWords("tag-edge=-0.0002m", grid).terms;
  EXPECT_LT((sum - parts).norm(), 1e-15);
}

TEST(TargetShapeWords, TheExampleHasEveryWord) {
  const AprilGrid grid;
  const std::string example = targetShapeExample();
  const TargetShape shape = targetShapeFromWords(example, grid);
  EXPECT_TRUE(shape.higher) << "s-bend";
  EXPECT_NEAR(shape.terms[kTargetTerms - 1], 1e-4, 1e-12) << "tag-edge";
  for (const char* word : {"bow", "twist", "stretch", "shear", "keystone", "s-bend", "tag-edge"}) {
    EXPECT_NE(example.find(std::string(word) + "="), std::string::npos) << word;
  }
}

TEST(TargetShapeWords, RefusesWhatItDoesNotKnow) {
  for (const char* words : {"", "bow", "bow=", "bow=1", "bow=1px", "bow=1m", "wobble=1mm",
                            "stretch=0.3mm", "stretch=9%", "bow=nan", "bow=1mm,,", "bow=1mm,"}) {
    EXPECT_THROW((void)targetShapeFromWords(words, AprilGrid()), InputError) << words;
  }
}

}  // namespace
}  // namespace plumbline
