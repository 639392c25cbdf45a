// SPDX-License-Identifier: BSD-3-Clause
// Errors of single corners and the filters that reject by them, on views whose errors are put in by
// hand. Not proven here: what filters do to a calibration (camera_simulated_test).
#include "calibrator/batch/corners.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

/// A camera of 400 px focal length, 1 m in front of a board that it sees straight on.
struct StraightOn {
  AprilGrid board;
  Intrinsics camera;
  Transform T_CF;
};

StraightOn straightOn() {
  StraightOn s;
  s.camera.resolution = {752, 480};
  s.camera.projection = Eigen::Vector4d(400, 400, 376, 240);
  s.camera.distortion_model = DistortionModel::kNone;
  s.camera.distortion.resize(0);
  s.T_CF.t << -0.3, -0.3, 1;
  return s;
}

/// Pixel of a corner: focal length times its place over the distance of 1 m.
Eigen::Vector2d pixelOf(const StraightOn& s, int id) {
  return 400 * (s.board.corner(id) - Eigen::Vector2d(0.3, 0.3)) + Eigen::Vector2d(376, 240);
}

/// One view of the board's first corners with these errors [px], in directions all round.
ImageView viewWithErrors(const StraightOn& s, const std::vector<double>& errors) {
  ImageView view;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const int id = static_cast<int>(k);
    const Eigen::Vector2d direction(std::cos(2.4 * id), std::sin(2.4 * id));
    view.corners.push_back({id, pixelOf(s, id) + errors[k] * direction});
  }
  return view;
}

std::vector<int> rejectedOf(const PackedView& view) {
  std::vector<int> ids;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] == 0) ids.push_back(view.id[k]);
  }
  return ids;
}

TEST(ViewErrors, AreMeasuredLessProjectedAndFarOffBehindTheCamera) {
  const StraightOn s = straightOn();
  ImageView view;
  view.corners = {{5, pixelOf(s, 5) + Eigen::Vector2d(2, -3)}};
  const PackedCorners corners(s.board, {view});
  const auto errors = viewErrors(s.camera, s.T_CF, corners.view(0));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_LT((errors[0] - Eigen::Vector2d(2, -3)).norm(), 1e-9);
  Transform behind = s.T_CF;
  behind.t.z() = -1;
  EXPECT_EQ(viewErrors(s.camera, behind, corners.view(0))[0], Eigen::Vector2d(1e5, 0));
}

// Errors of sqrt(2 ln 2) px are the median of noise with a deviation of 1 px on either axis.
TEST(RejectAboveSigma, IsByTheDeviationPerAxisOverAllViews) {
  const StraightOn s = straightOn();
  const double median = std::sqrt(2 * std::log(2));
  std::vector<double> one(40, median), other(40, median);
  one[7] = 3.9;
  other[11] = 4.1;
  other[12] = 1000;
  PackedCorners corners(s.board, {viewWithErrors(s, one), viewWithErrors(s, other)});
  EXPECT_EQ(rejectAboveSigma(corners, s.camera, {{0, s.T_CF}, {1, s.T_CF}}, 4), 2U);
  EXPECT_TRUE(rejectedOf(corners.view(0)).empty());
  EXPECT_EQ(rejectedOf(corners.view(1)), (std::vector<int>{11, 12}));
}

// A second round counts no corner again, and those of the first have no say in its limit.
TEST(RejectAboveSigma, KnowsNothingOfCornersThatAreRejectedAlready) {
  const StraightOn s = straightOn();
  std::vector<double> errors(40, std::sqrt(2 * std::log(2)));
  for (std::size_t k = 15; k < 40; ++k) errors[k] = 50;
  errors[3] = 5;
  PackedCorners corners(s.board, {viewWithErrors(s, errors)});
  for (int k = 15; k < 40; ++k) corners.setWeight(0, k, 0);
  EXPECT_EQ(rejectAboveSigma(corners, s.camera, {{0, s.T_CF}}, 4), 1U);
  EXPECT_EQ(corners.view(0).w[3], 0);
  for (int k = 0; k < 15; ++k) corners.setWeight(0, k, 0);
  EXPECT_EQ(rejectAboveSigma(corners, s.camera, {{0, s.T_CF}}, 4), 0U);  // none is left
}

/// What CornerFilter::kKalibr rejects of a view with a pose that fits exactly.
std::vector<int> rejectedLikeKalibr(const std::vector<double>& errors, bool without_last = false) {
  const StraightOn s = straightOn();
  PackedCorners corners(s.board, {viewWithErrors(s, errors)});
  const auto last = static_cast<int>(errors.size()) - 1;
  if (without_last) corners.setWeight(0, last, 0);
  const auto count = rejectLikeKalibr(corners, s.camera, {{0, s.T_CF}}, 1);
  std::vector<int> ids = rejectedOf(corners.view(0));
  if (without_last) {
    EXPECT_EQ(ids.back(), last);
    ids.pop_back();
  }
  EXPECT_EQ(count, ids.size());
  return ids;
}

// mean + 2 std of the errors of the view, whose pose hardly moves for one corner of 144; and 0.2 px
// at least.
TEST(RejectLikeKalibr, IsByMeanAndDeviationOfTheViewAndByAFifthOfAPixel) {
  std::vector<double> errors(144, 0);
  errors[70] = 0.15;
  EXPECT_TRUE(rejectedLikeKalibr(errors).empty());
  errors[70] = 0.3;
  EXPECT_EQ(rejectedLikeKalibr(errors), std::vector<int>{70});
  // Halves of 1 and 2 px: 1.5 + 2 * 0.5 is above all of them, 1.5 + 2 * 0.25 is not.
  for (std::size_t k = 0; k < errors.size(); ++k) errors[k] = k / 4 % 2 == 0 ? 1 : 2;
  EXPECT_TRUE(rejectedLikeKalibr(errors).empty());
  errors[70] = 3.5;
  EXPECT_EQ(rejectedLikeKalibr(errors), std::vector<int>{70});
  // Far off, but rejected before: it neither widens the limit nor is counted again.
  errors[143] = 100;
  EXPECT_EQ(rejectedLikeKalibr(errors, true), std::vector<int>{70});
}

TEST(AddReprojection, CountsWhatWasUsedAndAllThatWasOffered) {
  Session session;
  session.cameras.resize(2);
  session.cameras[0].views.resize(3);
  session.cameras[1].views.resize(2);
  session.cameras[0].views[0].corners.resize(5);
  session.cameras[1].views[1].corners.resize(7);
  StageSummary summary;
  // Of camera 0 two corners off by 3 and 5 px, of camera 1 two off by 1 px.
  addReprojection({{{3, 0}, {-3, 4}}, {{1, 0}, {0, 1}}}, session, summary);
  EXPECT_EQ(summary.views_offered, 5);
  EXPECT_EQ(summary.corners_offered, 12U);
  EXPECT_EQ(summary.corners_used, 4U);
  // Over corners, not over cameras: (9 + 25 + 1 + 1) / 4.
  EXPECT_DOUBLE_EQ(summary.reprojection.rmse_px, 3);
  ASSERT_EQ(summary.per_camera.size(), 2U);
  EXPECT_DOUBLE_EQ(summary.per_camera[0].rmse_px, std::sqrt(17));
  EXPECT_DOUBLE_EQ(summary.per_camera[1].rmse_px, 1);
}

}  // namespace
}  // namespace plumbline
