// SPDX-License-Identifier: BSD-3-Clause
// yac's results as calibrations.
#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/calibration_reader.h"
#include "tests/datasets/calibration/yac_text.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

TEST(YacResults, AreCalibrations) {
  const TemporaryFolder folder;
  const std::string text = test::kYacResult;
  std::string gap = text;
  gap.replace(gap.find("cam1:"), 5, "cam2:");
  EXPECT_EQ(faultOf([&] { (void)readCalibration(folder.write("gap.yaml", gap)); }),
            InputFault::kMissingKey);
  const Calibration c = readCalibration(folder.write("result.yaml", text));
  ASSERT_EQ(c.cameras.size(), 2U);
  EXPECT_EQ(c.cameras[1].intrinsics.distortion_model, DistortionModel::kEquidistant);
  EXPECT_EQ(c.cameras[1].T_C0Ci.t, Eigen::Vector3d(0.11, 0, 0));  // camera 1 to the right
  EXPECT_EQ(c.imu->T_SC0.t, Eigen::Vector3d(-0.02, -0.06, 0.01));
  EXPECT_EQ(c.imu->T_SC0.R(0, 1), -1);
  EXPECT_EQ(c.imu->timeOffset(), 0.0015);
  EXPECT_EQ(c.imu->noise.gyro_density, 1.7e-4);
  EXPECT_EQ(c.imu->noise.gyro_random_walk, 2e-5);
  EXPECT_EQ(c.imu->noise.accel_density, 2e-3);
  EXPECT_EQ(c.imu->noise.accel_random_walk, 3e-3);
  EXPECT_EQ(c.imu->noise.rate_hz, 200);
  EXPECT_EQ(c.imu->gravity_m_s2, 9.81);
  for (const char* g : {"1.62", "32.2"}) {  // of the moon, or in feet
    std::string other = text;
    other.replace(other.find("9.81"), 4, g);
    const auto refusal =
        refusalOf([&] { (void)readCalibration(folder.write("other.yaml", other)); });
    ASSERT_TRUE(refusal) << g;
    EXPECT_EQ(refusal->line(), 7);
  }
}

}  // namespace
}  // namespace plumbline
