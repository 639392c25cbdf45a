// SPDX-License-Identifier: BSD-3-Clause
// target_shape.yaml: what is written is read, and each fault of a file has its code and line.
#include <string>

#include <gtest/gtest.h>

#include "datasets/session/target.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

AprilGrid board() {
  AprilGrid grid;
  for (int j = 0; j < kTargetTerms; ++j) grid.shape.terms[j] = 1.1e-4 * (j - 5);
  const TargetCovariance A = TargetCovariance::Random();
  grid.shape.covariance = 1e-10 * (A * A.transpose());
  return grid;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class TargetShapeFile : public ::testing::Test {
 protected:
  std::optional<BadInput> refusal(const std::string& text) {
    const std::string file = folder_.write("target_shape.yaml", text);
    return refusalOf([&] { (void)readTargetShape(file, AprilGrid()); });
  }
  TemporaryFolder folder_;
};

TEST_F(TargetShapeFile, WhatIsWrittenIsRead) {
  const AprilGrid written = board();
  const std::string file = folder_.write("target_shape.yaml", targetShapeText(written));
  const TargetShape read = readTargetShape(file, AprilGrid());
  EXPECT_LT((read.terms - written.shape.terms).norm(), 1e-18);
  ASSERT_TRUE(read.covariance);
  EXPECT_TRUE(read.covariance->isApprox(*written.shape.covariance, 1e-12));
}

TEST_F(TargetShapeFile, WithoutACovarianceItIsExact) {
  AprilGrid written = board();
  written.shape.covariance.reset();
  const std::string file = folder_.write("target_shape.yaml", targetShapeText(written));
  EXPECT_FALSE(readTargetShape(file, AprilGrid()).covariance);
}

TEST_F(TargetShapeFile, HigherTermsAreReadAgain) {
  AprilGrid written = board();
  written.shape.higher = 1e-4 * HigherTerms::Random();
  written.shape.higher_std = 1e-5 * HigherTerms::Random().cwiseAbs();
  const std::string file = folder_.write("target_shape.yaml", targetShapeText(written));
  const TargetShape read = readTargetShape(file, AprilGrid());
  ASSERT_TRUE(read.higher);
  EXPECT_LT((*read.higher - *written.shape.higher).norm(), 1e-18);
  ASSERT_TRUE(read.higher_std);
  EXPECT_LT((*read.higher_std - *written.shape.higher_std).norm(), 1e-18);
}

TEST_F(TargetShapeFile, RemaindersOfCornersAreReadAgain) {
  AprilGrid written = board();
  written.shape.corners = 1e-4 * Eigen::VectorXd::Random(3 * written.cornerCount());
  const std::string file = folder_.write("target_shape.yaml", targetShapeText(written));
  const TargetShape read = readTargetShape(file, AprilGrid());
  ASSERT_TRUE(read.corners);
  EXPECT_LT((*read.corners - *written.shape.corners).norm(), 1e-17);
}

TEST_F(TargetShapeFile, FaultsHaveTheirCodes) {
  const std::string good = targetShapeText(board());
  AprilGrid corners = board();
  corners.shape.corners = Eigen::VectorXd::Constant(3 * corners.cornerCount(), 5e-5);
  const std::string uneven = targetShapeText(corners);
  AprilGrid lopsided = board();  // not symmetric
  lopsided.shape.covariance = 1e-10 * TargetCovariance::Identity();
  (*lopsided.shape.covariance)(0, 1) = 5e-11;
  const struct {
    std::string text;
    InputFault code;
  } cases[] = {
      {targetShapeText(lopsided), InputFault::kOutOfRange},
      {replaced(good, "tagRows: 6", "tagRows: 5"), InputFault::kContradiction},
      {replaced(good, "tagSize: 0.088", "tagSize: 0.08"), InputFault::kContradiction},
      {replaced(good, "tagSpacing: 0.3", "tagSpacing: 0.31"), InputFault::kContradiction},
      {replaced(good, "  shear:", "  sheer:"), InputFault::kMissingKey},
      {replaced(good, "terms_mm:", "terms_mm:\n  wobble: 1"), InputFault::kUnknownWord},
      {replaced(good, "  stretch: ", "  stretch: 6000 #"), InputFault::kOutOfRange},
      {replaced(good, "covariance_mm2:\n  - [", "covariance_mm2:\n  - [-1e9, "),
       InputFault::kOutOfRange},
      {good + "higher_mm: [[1, 2, 3]]\n", InputFault::kOutOfRange},
      {good + "corners_mm: [[1, 2, 3]]\n", InputFault::kOutOfRange},
      {replaced(uneven, "  - [0.05, ", "  - [51, "), InputFault::kOutOfRange},
      {replaced(uneven, "  - [0.05, ", "  - ["), InputFault::kOutOfRange},
      {good + "higher_mm:\n  - [51, 0, 0, 0, 0, 0, 0, 0, 0]\n  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n"
              "  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n",
       InputFault::kOutOfRange},
      {good + "higher_mm:\n  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n"
              "  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\nhigher_std_mm:\n"
              "  - [-1, 0, 0, 0, 0, 0, 0, 0, 0]\n  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n"
              "  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n",
       InputFault::kOutOfRange},
      {good + "higher_std_mm:\n  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n"
              "  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n  - [0, 0, 0, 0, 0, 0, 0, 0, 0]\n",
       InputFault::kMissingKey},
      {"", InputFault::kUnknownFile},
  };
  for (const auto& c : cases) {
    const auto fault = refusal(c.text);
    ASSERT_TRUE(fault) << c.text.substr(0, 400);
    EXPECT_EQ(fault->code(), c.code) << fault->what();
  }
}

}  // namespace
}  // namespace plumbline
