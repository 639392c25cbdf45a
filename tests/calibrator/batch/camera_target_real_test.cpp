// SPDX-License-Identifier: BSD-3-Clause
// The board of EuRoC's imu_april is stretched, keystoned and bowed. Two halves of the recording,
// calibrated apart, agree only when that is estimated; and only with a lens model that holds.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "tests/calibrator/batch/euroc_recording.h"

namespace plumbline {
namespace {

constexpr TimeNs kSplit = 36'000'000'000;  // [ns] from the first frame

const Session& recorded() {
  static const Session session = test::readEurocRecording(PLUMBLINE_SHARED_DATA).session;
  return session;
}

Session half(bool first) {
  Session part = recorded();
  const TimeNs start = part.cameras[0].views.front().t;
  for (CameraStream& camera : part.cameras) {
    std::erase_if(camera.views,
                  [&](const ImageView& view) { return (view.t - start < kSplit) != first; });
  }
  return part;
}

CameraStageOptions optionsOf(DistortionModel lens, TargetMode mode) {
  CameraStageOptions options;
  options.models.assign(2, {ProjectionModel::kPinhole, lens});
  options.cauchy_px = 0;
  options.target = mode;
  options.threads = 2;
  return options;
}

Eigen::Vector4d cam0(const Session& session, TargetMode mode) {
  const auto result = calibrateCameras(session, optionsOf(DistortionModel::kEquidistant, mode));
  EXPECT_TRUE(result.ok());
  return result->cameras[0].intrinsics.projection;
}

TEST(CameraTargetReal, HalvesAgreeWithTheBoardsOwnShape) {
  const Eigen::Vector4d d =
      (cam0(half(true), TargetMode::kAuto) - cam0(half(false), TargetMode::kAuto)).cwiseAbs();
  EXPECT_LT(d[0], 0.5);  // fu, fv [px]
  EXPECT_LT(d[1], 0.5);
  EXPECT_LT(d[2], 0.5);  // pu, pv
  EXPECT_LT(d[3], 0.3);
}

TEST(CameraTargetReal, WithTheFlatBoardTheyDifferByPixels) {
  const Eigen::Vector4d d =
      (cam0(half(true), TargetMode::kGiven) - cam0(half(false), TargetMode::kGiven)).cwiseAbs();
  EXPECT_GT(d[0], 5);
  EXPECT_GT(d[2], 2);
}

// An independent proof with every corner free finds cam0 at 461.2, 461.1, 364.5, 248.0.
TEST(CameraTargetReal, TheWholeRecordingGivesTheCameraOfAFreeFormBoard) {
  const auto result =
      calibrateCameras(recorded(), optionsOf(DistortionModel::kEquidistant, TargetMode::kAuto));
  ASSERT_TRUE(result.ok() && result->target_fit);
  EXPECT_EQ(result->target_fit->finding, TargetFinding::kBent);
  const Eigen::Vector4d free_form(461.20, 461.11, 364.54, 248.04);
  EXPECT_LT((result->cameras[0].intrinsics.projection - free_form).cwiseAbs().maxCoeff(), 0.3);
  EXPECT_LT(result->target_fit->held_out_px, 0.72 * result->target_fit->flat_held_out_px);
}

// radtan does not hold this lens: with terms it would move the focal length by 5 px.
TEST(CameraTargetReal, ALensModelThatMisfitsLeavesTheBoardAsStated) {
  const auto result =
      calibrateCameras(recorded(), optionsOf(DistortionModel::kRadtan, TargetMode::kAuto));
  ASSERT_TRUE(result.ok() && result->target_fit);
  EXPECT_EQ(result->target_fit->finding, TargetFinding::kLensMisfits);
  EXPECT_TRUE(result->target.isFlat());
}

}  // namespace
}  // namespace plumbline
