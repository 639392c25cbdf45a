// SPDX-License-Identifier: BSD-3-Clause
// The printed board: every tag is found again, at its size.
#include "datasets/sheet/target_sheet.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/image.h"
#include "calibrator/target/detector.h"
#include "tests/datasets/sheet/printed_page.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

SheetOptions april() {
  SheetOptions options;
  options.target.tag_size = 0.088;
  return options;
}

TEST(TargetSheet, EveryTagIsDetectedWhereTheGridHasIt) {
  const SheetOptions options = april();
  constexpr double kPixelsPerMm = 1.2;
  const GrayImage image = printedPage(targetSheetPdf(options), kPixelsPerMm);
  const AprilGridDetector detector(options.target);
  const std::vector<Corner> corners = detector.detect(image.view()).corners;
  ASSERT_EQ(corners.size(), static_cast<std::size_t>(options.target.cornerCount()));
  // Along x of the grid columns grow, along y rows fall; true size is the pixels' size.
  const auto& first = *std::min_element(
      corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
  for (const Corner& corner : corners) {
    const Eigen::Vector2d p =
        1e3 * kPixelsPerMm * (options.target.corner(corner.id) - options.target.corner(first.id));
    EXPECT_NEAR(corner.uv.x() - first.uv.x(), p.x(), 0.3) << corner.id;
    EXPECT_NEAR(first.uv.y() - corner.uv.y(), p.y(), 0.3) << corner.id;
  }
}

TEST(TargetSheet, ThePdfIsOnePageOfThePaperWithoutPixels) {
  const std::string pdf = targetSheetPdf(april());
  EXPECT_THAT(pdf, ::testing::StartsWith("%PDF-"));
  EXPECT_THAT(pdf, HasSubstr("/Count 1"));
  EXPECT_THAT(pdf, HasSubstr(kSheetMark));
  EXPECT_THAT(pdf, ::testing::Not(HasSubstr("/Subtype /Image")));
  // A0 upright in points.
  EXPECT_THAT(pdf, HasSubstr("2383.937"));
  EXPECT_THAT(pdf, HasSubstr("3370.393"));
}

TEST(TargetSheet, WhatDoesNotFitIsToldWithWhatDoes) {
  SheetOptions options = april();
  options.paper = *paperSizeFrom("A3");
  try {
    options.check();
    FAIL() << "88 mm tags on A3";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("tags of at most 35 mm fit"));
  }
  options.target.tag_size = 0.035;
  EXPECT_NO_THROW(options.check());
  options.target.rows = 600;
  EXPECT_THROW(options.check(), InputError);
}

// What is printed can be read.
TEST(TargetSheet, HasTheLimitsOfATargetFile) {
  SheetOptions options = april();
  options.target.tag_size = 0.001;
  for (const double spacing : {0.05, 3.5}) {
    options.target.spacing = spacing;
    EXPECT_THROW(options.check(), InputError) << spacing;
  }
  options.target.spacing = 3;
  EXPECT_NO_THROW(options.check());
  options.paper = {100000, 100000};
  options.target.tag_size = 6;
  EXPECT_THROW(options.check(), InputError);
}

TEST(TargetSheet, AWideBoardTurnsThePaper) {
  SheetOptions options = april();
  options.target.rows = 4;
  options.target.cols = 8;
  options.target.tag_size = 0.1;
  const Eigen::Vector2d page = pageSize(targetSheetPdf(options));
  EXPECT_GT(page.x(), page.y());
}

TEST(TargetSheet, PaperOfStatedSidesLiesAsItIsStated) {
  SheetOptions options = april();
  options.target.tag_size = 0.02;
  for (const char* word : {"300x200", "200x300"}) {
    options.paper = *paperSizeFrom(word);
    const Eigen::Vector2d page = pageSize(targetSheetPdf(options));
    EXPECT_NEAR(page.x(), options.paper.width_mm, 1e-3);
    EXPECT_NEAR(page.y(), options.paper.height_mm, 1e-3);
  }
  options.target.cols = 10;
  try {
    options.check();
    FAIL() << "10 tags of 20 mm side by side on 200 mm";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the paper 200 x 300 mm"));
    EXPECT_THAT(error.what(), HasSubstr("tags of at most 14 mm fit, or paper of 300 x 200 mm"));
  }
}

TEST(TargetSheet, PaperHasNamesOrSides) {
  EXPECT_EQ(paperSizeFrom("A4")->width_mm, 210);
  EXPECT_TRUE(paperSizeFrom("A4")->turns);
  EXPECT_EQ(paperSizeFrom("900x1200.5")->height_mm, 1200.5);
  for (const char* word : {"", "A9", "900", "x", "900x", "axb", "1x1", "900x1200mm"}) {
    EXPECT_FALSE(paperSizeFrom(word)) << word;
  }
}

}  // namespace
}  // namespace plumbline
