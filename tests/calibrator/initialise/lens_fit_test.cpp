// SPDX-License-Identifier: BSD-3-Clause
// A lens in another model.
#include "calibrator/initialise/lens_fit.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/camera/camera.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

TEST(LensFit, ALensInItsOwnModelIsItself) {
  for (const Intrinsics& lens : test::everyModel()) {
    if (!canBeCalibrated(lens.projection_model, lens.distortion_model)) continue;
    const auto fit = convertedLens(lens, lens.projection_model, lens.distortion_model);
    ASSERT_TRUE(fit) << toString(lens.projection_model) << toString(lens.distortion_model);
    // The projection: models with valleys (omni-radtan, rational) have many parameters for it.
    EXPECT_LT(fit->most_px, 0.02) << toString(lens.projection_model)
                                  << toString(lens.distortion_model);
  }
}

TEST(LensFit, RationalHoldsRadtan) {
  const auto fit =
      convertedLens(test::radtanCamera(), ProjectionModel::kPinhole, DistortionModel::kRational);
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->most_px, 1e-2);
}

// Wide lenses whose way to the rational model leads through lenses that fold back: a fit that stays
// before the fold ends at 1.9 to 26 px.
TEST(LensFit, RationalHoldsWideLenses) {
  const auto pinhole = ProjectionModel::kPinhole;
  const Intrinsics tumvi = test::equidistantCamera();
  const Intrinsics equidistant = test::cameraOf(pinhole, DistortionModel::kEquidistant,
                                                {300, 301, 375, 241}, {-0.01, 0.02, -0.01, 0.002});
  const Intrinsics fov =
      test::cameraOf(pinhole, DistortionModel::kFov, {300, 302, 370, 245}, {0.9});
  const Intrinsics omni = test::cameraOf(ProjectionModel::kOmni, DistortionModel::kRadtan,
                                         {1.2, 700, 698, 370, 245}, {-0.2, 0.1, 1e-3, -2e-3});
  const std::vector<std::pair<Intrinsics, double>> lenses = {
      {tumvi, 0.25}, {equidistant, 0.04}, {fov, 0.004}, {omni, 0.25}};
  for (const auto& [lens, most] : lenses) {
    const auto fit = convertedLens(lens, pinhole, DistortionModel::kRational);
    ASSERT_TRUE(fit) << toString(lens.distortion_model);
    EXPECT_LT(fit->rms_px, most) << toString(lens.distortion_model);
  }
}

// A double sphere of 220 degrees: a pinhole shows what lies ahead, the rest is not counted.
TEST(LensFit, APinholeTakesThePartThatItCanShow) {
  Intrinsics wide = test::doubleSphereCamera();
  wide.projection.tail<4>() << 150, 150, 375.5, 239.5;
  const auto fit = convertedLens(wide, ProjectionModel::kPinhole, DistortionModel::kEquidistant);
  const auto whole = convertedLens(wide, ProjectionModel::kEucm, DistortionModel::kNone);
  ASSERT_TRUE(fit && whole);
  EXPECT_LT(fit->points, whole->points);
  EXPECT_GT(fit->points, 500);
  EXPECT_LT(fit->rms_px, 0.1);
}

TEST(LensFit, SaysHowMuchAModelMisses) {
  const auto fit =
      convertedLens(test::equidistantCamera(), ProjectionModel::kPinhole, DistortionModel::kNone);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->rms_px, 1);
  EXPECT_GE(fit->most_px, fit->rms_px);
  EXPECT_FALSE(fitLens(test::radtanCamera(), {}));
}

// Two equations a point: a pinhole with four coefficients needs four. What cannot be shown is not
// counted.
TEST(LensFit, CountsThePointsThatTheModelShows) {
  const Intrinsics lens = test::radtanCamera();
  std::vector<SeenPoint> points;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.3, 0.1}, {-0.2, 0.3}, {0.1, -0.4}}) {
    const Eigen::Vector3d p_C(x, y, 1);
    points.push_back({p_C, project(lens, p_C).value()});
  }
  points.push_back({{0, 0, -1}, {100, 100}});
  points.push_back({{40, 0, 1}, {700, 240}});  // 88.6 degrees off the axis
  const auto fit = fitLens(lens, points);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->points, 4);
  EXPECT_LT(fit->most_px, 1e-6);
  points.erase(points.begin());
  EXPECT_FALSE(fitLens(lens, points));
}

// One point that is off by 4 px among many that are not: what is left lies in it.
TEST(LensFit, TheLargestErrorAndTheMeanSquareAreOfTheSamePoints) {
  Intrinsics lens = test::radtanCamera();
  std::vector<SeenPoint> points;
  for (int i = -10; i <= 10; ++i) {
    for (int j = -6; j <= 6; ++j) {
      const Eigen::Vector3d p_C(0.05 * i, 0.05 * j, 1);
      points.push_back({p_C, project(lens, p_C).value()});
    }
  }
  points[100].uv.x() += 4;
  const auto fit = fitLens(lens, points);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->points, 21 * 13);
  EXPECT_NEAR(fit->most_px, 4, 0.2);
  EXPECT_NEAR(fit->rms_px, 4 / std::sqrt(21 * 13), 0.01);
}

}  // namespace
}  // namespace plumbline
