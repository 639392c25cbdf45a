// SPDX-License-Identifier: BSD-3-Clause
// Differences of projections over the image: where they are defined.
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "evaluate/compare/compare_calibrations.h"
#include "evaluate/compare/findings.h"
#include "tests/evaluate/compare/compared_rigs.h"

namespace plumbline {
namespace {

using test::stereo;

TEST(DifferenceMaps, WithoutRaysUnderBothTheMapIsUndefined) {
  Calibration blind = stereo();
  for (CameraCalibration& camera : blind.cameras) {
    Intrinsics& k = camera.intrinsics;
    k.projection_model = ProjectionModel::kEucm;
    k.distortion_model = DistortionModel::kNone;
    // Rays within half a pixel of the principal point, which is none of the grid.
    k.projection.resize(6);
    k.projection << 1, 1e6, 458, 457, 367, 248;
    k.distortion.resize(0);
  }
  const MapOptions options;
  const auto maps =
      differenceMaps({"a", "", "", stereo(), {}}, {"b", "", "", blind, {}}, {}, options);
  ASSERT_EQ(maps.size(), 2 * options.ranges_m.size());
  for (const ImageMap& map : maps) {
    EXPECT_EQ(extremesOf(map).undefined, 1);
    EXPECT_NE(map.method.find("fewer than three pixels have a ray under both"), std::string::npos);
  }
}

// Rays are there: the request leaves them out.
TEST(DifferenceMaps, AFocusWithoutPointsOfTheGridIsRefused) {
  const ComparedCalibration a{"a", "", "", stereo(), {}}, b{"b", "", "", stereo(), {}};
  MapOptions narrow, coarse;
  narrow.focus_radius_px = 20;
  coarse.grid = {5, 3};
  for (const MapOptions& options : {narrow, coarse}) {
    EXPECT_THROW(differenceMaps(a, b, {}, options), InputError);
    EXPECT_THROW(options.checkFocus({752, 480}), InputError);
  }
  // Both ways out.
  coarse.focus_radius_px = 300;
  EXPECT_EQ(differenceMaps(a, b, {}, coarse).size(), 4u);
  narrow.grid = {101, 71};
  EXPECT_EQ(differenceMaps(a, b, {}, narrow).size(), 4u);
}

TEST(DifferenceMaps, DeviationsThatGiveNoWeightsLeaveTheFocus) {
  const ComparedCalibration a{"a", "", "", stereo(), {}}, b{"b", "", "", stereo(), {}};
  MapOptions options;
  options.ranges_m = {1};
  std::vector<ImageMap> uncertainties;
  for (const char* label : {"a", "b"}) {
    for (const CameraCalibration& camera : stereo().cameras) {
      uncertainties.push_back(imageMapOf(camera, label, 1, options.grid));
      uncertainties.back().values.assign(static_cast<std::size_t>(options.grid.size()), 0);
    }
  }
  const auto maps = differenceMaps(a, b, uncertainties, options);
  ASSERT_EQ(maps.size(), 2u);
  for (const ImageMap& map : maps) {
    EXPECT_EQ(map.method, "fit over the focus region");
    EXPECT_EQ(extremesOf(map).undefined, 0);
  }
}

}  // namespace
}  // namespace plumbline
