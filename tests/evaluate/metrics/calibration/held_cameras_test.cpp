// SPDX-License-Identifier: BSD-3-Clause
// Cameras that were held on a recording against those that its corners ask for.
#include "evaluate/metrics/calibration/held_cameras.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

class HeldCameras : public testing::Test {
 protected:
  HeldCameras() {
    SimulationOptions options;
    options.duration_s = 8;
    options.seed = 4;
    options.camera_rate_hz = 5;
    const SimulatedSession made = simulateSession(simulatedRig("euroc"), options);
    session_ = made.session;
    cameras_ = made.truth.cameras;
  }

  std::vector<Finding> judged() const {
    const auto held = scoreCameras(session_, cameras_, options_.camera);
    EXPECT_TRUE(held) << held.failure();
    return judgeHeldCameras(*held, session_, options_);
  }

  Session session_;
  std::vector<CameraCalibration> cameras_;
  ScoreOptions options_;
};

TEST_F(HeldCameras, TheTrueOnesDifferByNoiseAlone) {
  const std::vector<Finding> found = judged();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, VerdictLevel::kGood) << found[0].evidence;
  EXPECT_LT(found[0].value, 1);
  EXPECT_EQ(found[0].subject, FindingSubject::kCameras);
}

// A millimetre is two bounds, whatever of it the poses absorb; what is not off is not blamed.
TEST_F(HeldCameras, ABaselineThatIsOffIsToldInItsUnit) {
  cameras_[1].T_C0Ci.t.x() += 1e-3;
  const std::vector<Finding> found = judged();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, VerdictLevel::kCaution) << found[0].evidence;
  EXPECT_NEAR(found[0].value, 2, 0.5) << found[0].evidence;
  EXPECT_THAT(found[0].evidence, HasSubstr("T_C0C1 by "));
}

// One percent of fu moves a pixel by a hundredth of its distance from the centre: by d at first
// order, less what a rotation takes.
TEST_F(HeldCameras, AFocalLengthThatIsOffIsToldInPixelsOfItsCamera) {
  cameras_[0].intrinsics.projection.head<2>() *= 1.01;
  const std::vector<Finding> found = judged();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, VerdictLevel::kCaution) << found[0].evidence;
  EXPECT_GT(found[0].value, 3) << "1.5 px and more";
  EXPECT_LT(found[0].value, 10) << "not 5 px";
}

TEST_F(HeldCameras, ARecordingThatDoesNotDetermineThemJudgesNothing) {
  for (CameraStream& camera : session_.cameras) camera.views.resize(1);
  const std::vector<Finding> found = judged();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(isNotJudged(found[0])) << found[0].evidence;
  EXPECT_THAT(found[0].evidence, HasSubstr("does not determine the cameras"));
}

TEST_F(HeldCameras, ModelsThatCanOnlyBeScoredAreNotTried) {
  CameraStageResult held;
  held.cameras = cameras_;
  held.cameras[0].intrinsics.projection_model = ProjectionModel::kOmni;
  held.cameras[0].intrinsics.distortion_model = DistortionModel::kEquidistant;
  EXPECT_TRUE(judgeHeldCameras(held, session_, options_).empty());
}

}  // namespace
}  // namespace plumbline
