// SPDX-License-Identifier: BSD-3-Clause
// A lens that shows nearly 180 degrees, in the models that end there: corners near the rim are left
// out, and frames that have no others with them.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

/// 180 degrees over the width of the image.
Intrinsics wideLens() {
  Intrinsics lens = test::equidistantCamera();
  lens.projection << 162.9, 162.7, 254.932, 256.897;
  return lens;
}

SimulatedSession wideRecording() {
  SimulatedRig rig = simulatedRig("tumvi");
  rig.calibration.cameras.resize(1);
  rig.calibration.cameras[0].intrinsics = wideLens();
  SimulationOptions options;
  options.duration_s = 16;
  options.camera_rate_hz = 5;
  options.corner_sigma_px = 0.1;
  return simulateSession(rig, options);
}

/// The board far off at the rim: its first column of tags begins `angle_rad` from the axis.
std::vector<Corner> cornersAtTheRim(const AprilGrid& board, double angle_rad, double distance_m) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad);
  Transform T_CF;
  T_CF.R << c, 0, -s, 0, -1, 0, -s, 0, -c;  // it faces the camera, x away from the axis
  T_CF.t = distance_m * Eigen::Vector3d(s, 0, c);
  std::vector<Corner> corners;
  for (int id = 0; id < board.cornerCount(); ++id) {
    if (id / 4 % board.cols > 0) continue;
    const Eigen::Vector2d p = board.corner(id);
    const auto uv = project(wideLens(), T_CF * Eigen::Vector3d(p.x(), p.y(), 0));
    if (uv) corners.push_back({id, *uv});
  }
  return corners;
}

void addFrameAtTheRim(SimulatedSession& s) {
  std::vector<ImageView>& views = s.session.cameras[0].views;
  views.push_back(
      {views.back().t + 200'000'000, cornersAtTheRim(s.session.target, 89.1 * kDegree, 8)});
  ASSERT_EQ(views.back().corners.size(), 24U);
}

TEST(CameraOfAWideLens, AFrameThatShowsTheBoardAtTheRimAloneIsLeftOut) {
  SimulatedSession s = wideRecording();
  const auto without = calibrateCameras(s.session);
  ASSERT_TRUE(without.ok()) << without.failure();
  addFrameAtTheRim(s);
  for (const double cauchy_px : {0.0, 3.0}) {
    CameraStageOptions options;
    options.start = s.truth.cameras;
    options.cauchy_px = cauchy_px;
    const auto result = calibrateCameras(s.session, options);
    ASSERT_TRUE(result.ok()) << result.failure();
    EXPECT_EQ(result->summary.views_used, without->summary.views_used);
    EXPECT_NEAR(result->summary.reprojection.rmse_px, 0.1 * std::sqrt(2), 0.004);
  }
}

TEST(CameraOfAWideLens, SoItIsWhereTheModelIsChosen) {
  SimulatedSession s = wideRecording();
  addFrameAtTheRim(s);
  CameraStageOptions options;
  options.model_mode = ModelMode::kAuto;
  const auto result = calibrateCameras(s.session, options);
  ASSERT_TRUE(result.ok()) << result.failure();
  ASSERT_EQ(result->cameras[0].intrinsics.projection_model, ProjectionModel::kPinhole);
  EXPECT_EQ(result->summary.views_used, result->summary.views_offered - 1);
  EXPECT_NEAR(result->summary.reprojection.rmse_px, 0.1 * std::sqrt(2), 0.004);
}

}  // namespace
}  // namespace plumbline
