// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

TEST(SimulatedRig, PresetsArePlausibleRigs) {
  for (const std::string& name : simulatedRigNames()) {
    SCOPED_TRACE(name);
    const SimulatedRig rig = simulatedRig(name);
    const auto& cameras = rig.calibration.cameras;
    ASSERT_EQ(cameras.size(), 2U);
    ASSERT_TRUE(rig.calibration.imu.has_value());
    EXPECT_EQ(cameras[0].T_C0Ci.matrix(), Eigen::Matrix4d::Identity());
    EXPECT_NEAR(cameras[1].T_C0Ci.t.norm(), 0.08, 0.04);
    EXPECT_LT(rotationAngle(cameras[1].T_C0Ci.R), 0.1);
    EXPECT_NE(rig.calibration.imu->timeOffset(), 0);
    EXPECT_LT(rig.calibration.imu->T_SC0.t.norm(), 0.15);
    EXPECT_EQ(rig.camera_rate_hz, name == "d435i" ? 15 : 20);
    EXPECT_EQ(rig.calibration.imu->noise.rate_hz, name == "d435i" ? 400 : 200);
  }
}

// EuRoC: baseline and forward axis as everybody knows them; a transposed matrix would fail.
TEST(SimulatedRig, EurocHasItsPublishedGeometry) {
  const Calibration c = simulatedRig("euroc").calibration;
  EXPECT_NEAR(c.cameras[1].T_C0Ci.t.x(), 0.1101, 1e-3);  // camera 1 stands to the right
  EXPECT_NEAR(c.imu->T_SC0.t.y(), -0.064676986768, 1e-12);
  EXPECT_GT((c.imu->T_SC0.R * Eigen::Vector3d::UnitZ()).z(), 0.99);  // cameras look along z of S
}

TEST(SimulatedRig, UnknownNameIsRefusedWithTheKnownOnes) {
  try {
    (void)simulatedRig("kinect");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("kinect"),
                                             testing::HasSubstr("euroc, tumvi, d435i")));
  }
}

// A camera calibration needs most of the target most of the time, and all of the image.
TEST(SimulatedRig, TargetIsSeenByEveryCameraOfEveryPreset) {
  for (const std::string& name : simulatedRigNames()) {
    SimulationOptions options;
    options.duration_s = 40;
    options.camera_rate_hz = 5;
    options.imu_rate_hz = 20;
    const SimulatedSession s = simulateSession(simulatedRig(name), options);
    for (const CameraStream& camera : s.session.cameras) {
      SCOPED_TRACE(name + " " + camera.name);
      std::size_t corners = 0;
      int seeing = 0;
      Eigen::Matrix<int, 4, 4> cells = Eigen::Matrix<int, 4, 4>::Zero();
      for (const ImageView& view : camera.views) {
        corners += view.corners.size();
        seeing += view.corners.size() >= 16;
        for (const Corner& c : view.corners) {
          const auto col = static_cast<Eigen::Index>(4 * c.uv.x() / camera.resolution.width);
          const auto row = static_cast<Eigen::Index>(4 * c.uv.y() / camera.resolution.height);
          ++cells(row, col);
        }
      }
      const auto views = static_cast<double>(camera.views.size());
      EXPECT_EQ(camera.views.size(), 200U);
      EXPECT_GT(static_cast<double>(corners) / views, 90);
      EXPECT_GT(seeing / views, 0.97);
      EXPECT_GT(cells.minCoeff(), 20) << cells;
    }
  }
}

}  // namespace
}  // namespace plumbline
