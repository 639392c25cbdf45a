// SPDX-License-Identifier: BSD-3-Clause
// Maps over an image: their grid, and the scales by which a reader compares several.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "report/html/figure.h"
#include "report/html/scene.h"
#include "report/html/section.h"

namespace plumbline::html_internal {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

// Five columns and three rows from the centre of the first pixel to that of the last.
ImageMap example() {
  ImageMap map;
  map.columns = 5;
  map.rows = 3;
  map.width = 641;
  map.height = 481;
  map.values.assign(15, 0.5);
  return map;
}

TEST(ImageMaps, TheGridReachesTheOutermostPixels) {
  const ImageMap map = example();
  EXPECT_EQ(stepX(map), 160);
  EXPECT_EQ(stepY(map), 240);
  const PlotFrame frame = mapFrame(map, "title", 0.5);
  EXPECT_EQ(*frame.x.range, (Range{-80, 720}));
  EXPECT_EQ(*frame.y.range, (Range{-120, 600}));
  EXPECT_TRUE(frame.y.inverted) << "rows of an image go down";
  EXPECT_TRUE(frame.equal_axes);
}

TEST(ImageMaps, AreSoundWithAValueForEachPoint) {
  EXPECT_TRUE(sound(example()));
  const auto refused = [](auto change) {
    ImageMap map = example();
    change(map);
    return !sound(map);
  };
  EXPECT_TRUE(refused([](auto& m) { m.values.pop_back(); }));
  EXPECT_TRUE(refused([](auto& m) { m.width = 1; }));
  EXPECT_TRUE(refused([](auto& m) { m.height = 0; }));
  EXPECT_TRUE(refused([](auto& m) { m.columns = m.rows = 0, m.values.clear(); }));
  EXPECT_TRUE(refused([](auto& m) { m.columns = -5, m.rows = -3; }));
}

TEST(ImageMaps, WhatIsNotFiniteIsBlank) {
  ImageMap map = example();
  map.values[3] = std::numeric_limits<double>::infinity();
  const HeatMap plot = heatMap(map, "title", "std [px]");
  EXPECT_TRUE(std::isnan(plot.values[3]));
  EXPECT_EQ(plot.values[4], 0.5);
  EXPECT_EQ(plot.columns, 5);
  EXPECT_EQ(plot.rows, 3);
  EXPECT_EQ(rangeText(1.5), "at 1.5 m");
  EXPECT_EQ(rangeText(std::numeric_limits<double>::infinity()), "at infinity");
}

TEST(ScaleAlike, OneWildCellDoesNotPaleTheOthers) {
  std::vector<HeatMap> maps(2);
  for (int i = 0; i < 100; ++i) maps[0].values.push_back(0.01 * i);
  for (int i = 0; i < 100; ++i) maps[1].values.push_back(i == 7 ? 50 : kNan);
  scaleAlike(addressesOf(maps));
  ASSERT_TRUE(maps[0].value_range && maps[1].value_range);
  EXPECT_EQ(*maps[0].value_range, *maps[1].value_range);
  EXPECT_EQ(maps[0].value_range->min, 0);
  EXPECT_NEAR(maps[0].value_range->max, 0.98, 0.02);
  EXPECT_NE(clampText(maps[1]).find("the largest is 50 px."), std::string::npos);
  EXPECT_NE(clampText(maps[0]).find("Colours end at 0.9"), std::string::npos);
  maps[0].values = {0.5, kNan};
  EXPECT_EQ(clampText(maps[0]), "") << "all within the colours";
  std::vector<HeatMap> nothing(1);
  scaleAlike(addressesOf(nothing));
  EXPECT_EQ(*nothing[0].value_range, (Range{0, 1}));
}

TEST(MagnifyAlike, ATypicalArrowReachesAsFarAsAsked) {
  std::vector<VectorField> fields(2);
  for (int i = 0; i < 19; ++i) fields[0].arrows.push_back({0, 0, 0.3, 0.4, ""});
  fields[1].arrows.push_back({0, 0, 0, -3, ""});
  magnifyAlike(addressesOf(fields), 40);
  for (const VectorField& field : fields) {
    EXPECT_NEAR(field.magnification * 0.5, 40, 1e-9);
    EXPECT_NEAR(field.longest, 1, 1e-9);
    EXPECT_NEAR(field.reference, 0.5, 1e-9);
    EXPECT_EQ(field.reference_label, "0.5 px");
  }
  EXPECT_EQ(cutText(fields[0]), "");
  EXPECT_EQ(cutText(fields[1]), " 1 arrow above 1 px is shortened to that length, in red.");
  fields[1].arrows.push_back({0, 0, 1.1, 0, ""});
  EXPECT_EQ(cutText(fields[1]), " 2 arrows above 1 px are shortened to that length, in red.");
}

// Round lengths that a reader takes in: 1, 2 or 5 times a power of ten.
TEST(MagnifyAlike, TheKeyShowsARoundLength) {
  for (const auto& [typical, round] :
       {std::pair{0.19, 0.1}, {0.21, 0.2}, {0.49, 0.2}, {0.51, 0.5}, {0.99, 0.5}, {12.0, 10.0}}) {
    std::vector<VectorField> fields(1);
    fields[0].arrows.assign(10, {0, 0, typical, 0, ""});
    magnifyAlike(addressesOf(fields), 1);
    EXPECT_NEAR(fields[0].reference, round, 1e-9) << typical;
  }
}

TEST(Frustum, HasTheApexAndTheImagesCornersAroundIt) {
  Intrinsics lens;
  lens.projection = Eigen::Vector4d(400, 200, 300, 100);
  lens.resolution = {700, 500};
  const Transform T_FC(expSO3({0, std::numbers::pi, 0}), {1, 2, 3});  // looks along -z
  const auto points = frustum(lens, T_FC, 0.1);
  ASSERT_EQ(points.size(), 5U);
  EXPECT_EQ(points[0], T_FC.t);
  // Tangents -0.75 and 1 along u, -0.5 along v, and 2 downwards, which is cut at 1.7.
  const Eigen::Vector3d expected[] = {{-0.75, -0.5, 1}, {1, -0.5, 1}, {1, 1.7, 1}, {-0.75, 1.7, 1}};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LT((points[k + 1] - T_FC * Eigen::Vector3d(0.1 * expected[k])).norm(), 1e-12) << k;
  }
}

// Of each camera and frame over its used corners; none where a camera saw nothing.
TEST(FrameRmse, IsOfTheUsedCornersOfACamerasFrame) {
  CalibrationRecord record;
  CameraStageResult& stage = record.camera.emplace();
  stage.cameras.resize(2);
  stage.frames = {{2'000'000'000, {0, 0}}, {2'500'000'000, {1, 1}}};
  const auto corner = [](int camera, int frame, float u, float v, bool used) {
    return CornerResidual{camera, frame, 0, {0, 0}, {u, v}, used};
  };
  stage.residuals = {corner(0, 0, 3, 4, true), corner(0, 0, 0, 0, true), corner(0, 0, 90, 0, false),
                     corner(1, 1, 0, 2, true)};
  const auto rmse = frameRmse(cameraView(record));
  EXPECT_NEAR(rmse[0][0], std::sqrt(12.5), 1e-6);
  EXPECT_TRUE(std::isnan(rmse[0][1]));
  EXPECT_TRUE(std::isnan(rmse[1][0]));
  EXPECT_NEAR(rmse[1][1], 2, 1e-6);
  EXPECT_EQ(frameSeconds(cameraView(record)), (std::vector<double>{0, 0.5}));
}

}  // namespace
}  // namespace plumbline::html_internal
