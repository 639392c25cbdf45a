// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/camera/camera.h"
#include "evaluate/calibration/export_calibration.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

// The wide lens of a 752 x 480 image, whose last column and row no step of 8 px from 0 meets.
Calibration oneCamera() {
  Calibration calibration;
  CameraCalibration& camera = calibration.cameras.emplace_back();
  camera.name = "cam0";
  camera.intrinsics.projection_model = ProjectionModel::kPinhole;
  camera.intrinsics.distortion_model = DistortionModel::kRadtan;
  camera.intrinsics.projection = Eigen::Vector4d(458, 457, 367, 248);
  camera.intrinsics.distortion = Eigen::Vector4d(-0.283, 0.074, 0.0002, 1.8e-5);
  camera.intrinsics.resolution = {752, 480};
  return calibration;
}

TEST(ConvertModels, TheLargestErrorIsThatOfTheWholeImage) {
  const Calibration before = oneCamera();
  Calibration after = before;
  const auto conversions =
      convertModels(after, {ProjectionModel::kPinhole, DistortionModel::kEquidistant}, "c.yaml");
  ASSERT_EQ(conversions.size(), 1U);
  double most = 0;
  for (int u = 0; u < 752; ++u) {
    for (const int v : {0, 120, 240, 360, 479}) {
      const Eigen::Vector2d uv(u, v);
      const auto ray = unproject(before.cameras[0].intrinsics, uv);
      const auto again = ray ? project(after.cameras[0].intrinsics, *ray) : std::nullopt;
      if (again) most = std::max(most, (*again - uv).norm());
    }
  }
  EXPECT_GE(conversions[0].most_px, most - 1e-9);
  EXPECT_GT(conversions[0].most_px, conversions[0].rms_px);
  EXPECT_EQ(conversions[0].outside, 0);
}

// TUM-VI's lens: 76 degrees at the image's sides, 108 in its corners.
Calibration fisheyeCamera() {
  Calibration calibration;
  calibration.cameras.emplace_back().name = "cam0";
  calibration.cameras.front().intrinsics = test::equidistantCamera();
  return calibration;
}

TEST(ConvertModels, APinholeLeavesOutWhatItCannotShow) {
  Calibration fisheye = fisheyeCamera();
  const auto conversions =
      convertModels(fisheye, {ProjectionModel::kPinhole, DistortionModel::kRational}, "c.yaml");
  ASSERT_EQ(conversions.size(), 1U);
  EXPECT_LT(conversions[0].rms_px, 0.3);
  EXPECT_LT(conversions[0].most_px, 3);
  EXPECT_GT(conversions[0].outside, 0.01);
  EXPECT_LT(conversions[0].outside, 0.03);
  EXPECT_THAT(conversionText(conversions[0]), testing::HasSubstr("% of the image, 88 degrees"));
}

TEST(ConvertModels, AUselessLensIsRefusedByFileAndCamera) {
  for (const DistortionModel model : {DistortionModel::kRadtan, DistortionModel::kNone}) {
    Calibration fisheye = fisheyeCamera();
    try {
      (void)convertModels(fisheye, {ProjectionModel::kPinhole, model}, "c.yaml");
      ADD_FAILURE() << toString(model);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(),
                  testing::AllOf(testing::StartsWith("c.yaml: cam0 is pinhole-equidistant"),
                                 testing::HasSubstr("choose another model")));
    }
  }
}

}  // namespace
}  // namespace plumbline
