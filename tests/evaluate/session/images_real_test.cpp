// SPDX-License-Identifier: BSD-3-Clause
// From real images to a calibration, as `plumbline calibrate` does it.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "evaluate/session/load_session.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

// The focal lengths published with EuRoC's data for this rig (sensor.yaml of cam0 and cam1).
constexpr double kPublished[2][2] = {{458.654, 457.296}, {457.587, 456.134}};

TEST(RealImages, FocalLengthsAreEurocsWithinHalfAPercent) {
  const std::string data = PLUMBLINE_SHARED_DATA;
  ASSERT_TRUE(std::filesystem::is_directory(data))
      << data << " is missing: configure with -DPLUMBLINE_SHARED_DATA=FOLDER";
  LoadRequest request;
  request.session = data + "/euroc_cam_april_images";
  request.read.read_imu = false;
  const LoadedSession loaded = loadSession(request, [](const std::string&, double) {});
  const auto result = calibrateCameras(loaded.session);
  ASSERT_TRUE(result.ok()) << result.failure();
  ASSERT_EQ(result->cameras.size(), 2u);
  for (int c = 0; c < 2; ++c) {
    for (int axis = 0; axis < 2; ++axis) {
      const double published = kPublished[c][axis];
      EXPECT_NEAR(result->cameras[c].intrinsics.projection[axis], published, 0.005 * published)
          << "cam" << c << " axis " << axis;
    }
  }
  EXPECT_EQ(result->summary.views_used, 52);
}

// With 0.274 for 0.3 some images alone are more than 10 % off, and all together are not.
TEST(RealImages, ASpacingNearTheBoundIsJudgedAlikeWithTheCache) {
  const TemporaryFolder folder;
  LoadRequest request;
  request.session = std::string(PLUMBLINE_SHARED_DATA) + "/euroc_cam_april_images";
  request.read.read_imu = false;
  request.only = {"cam0"};
  request.cache = folder.path("cache");
  folder.write("target.yaml",
               "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\n"
               "tagSpacing: 0.274\n");
  request.read.target_path = folder.path("target.yaml");
  const LoadedSession searched = loadSession(request, [](const std::string&, double) {});
  const LoadedSession cached = loadSession(request, [](const std::string&, double) {});
  ASSERT_TRUE(searched.shown_spacing);
  EXPECT_EQ(searched.shown_spacing, cached.shown_spacing);
}

}  // namespace
}  // namespace plumbline
