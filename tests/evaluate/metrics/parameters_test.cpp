// SPDX-License-Identifier: BSD-3-Clause
// A calibration as a list of parameters, and the change between two.
#include "evaluate/metrics/calibration/parameters.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/rig.h"

namespace plumbline {
namespace {

Calibration calibration() { return simulatedRig("euroc").calibration; }

std::size_t indexOf(const std::vector<CalibrationParameter>& list, const std::string& name) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == name) return i;
  }
  ADD_FAILURE() << name;
  return 0;
}

TEST(CalibrationParameters, AreListedCameraByCameraThenTransformsThenOffset) {
  const auto list = calibrationParameters(calibration());
  ASSERT_EQ(list.size(), 8u + 8 + 6 + 6 + 1);
  EXPECT_EQ(list[0].name, "cam0.fu");
  EXPECT_EQ(list[0].unit, "px");
  EXPECT_EQ(list[15].name, "cam1.p2");
  EXPECT_EQ(list[16].name, "T_C0C1.tx");
  EXPECT_EQ(list[22].name, "T_SC0.tx");
  EXPECT_EQ(list[27].unit, "rad");
  EXPECT_EQ(list[28].name, "time_offset");
  EXPECT_EQ(list[28].value, calibration().imu->timeOffset());
}

TEST(CalibrationParameters, ByTheirNamesCamerasAreThoseOfTheFile) {
  Calibration c = calibration();
  c.cameras[0].name = "cam1";
  c.cameras[1].name = "right";
  const auto list = namedParameters(c);
  ASSERT_EQ(list.size(), calibrationParameters(c).size());
  EXPECT_EQ(list[0].name, "cam1.fu");
  EXPECT_EQ(list[15].name, "right.p2");
  EXPECT_EQ(list[16].name, "T_C0C1.tx");
  EXPECT_EQ(list[28].name, "time_offset");
}

TEST(CalibrationParameters, ChangesOfTransformsAreTangents) {
  const Calibration from = calibration();
  Calibration to = from;
  Vector6d d;
  d << 1e-3, -2e-3, 3e-3, 0.01, -0.02, 0.03;
  to.imu->T_SC0 = boxplus(from.imu->T_SC0, d);
  to.cameras[1].intrinsics.projection[2] += 0.25;
  to.imu->time_offsets[0].s -= 1e-4;
  const auto list = calibrationParameters(from);
  const Eigen::VectorXd change = calibrationChange(to, from);
  ASSERT_EQ(static_cast<std::size_t>(change.size()), list.size());
  const auto at = static_cast<Eigen::Index>(indexOf(list, "T_SC0.tx"));
  EXPECT_LT((change.segment<6>(at) - d).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(change[static_cast<Eigen::Index>(indexOf(list, "cam1.pu"))], 0.25);
  EXPECT_NEAR(change[static_cast<Eigen::Index>(indexOf(list, "time_offset"))], -1e-4, 1e-15);
  EXPECT_EQ((change.array().abs() > 1e-14).count(), 8);
}

TEST(CalibrationParameters, OtherModelsDoNotCompare) {
  const Calibration from = calibration();
  Calibration to = from;
  to.cameras[0].intrinsics.distortion_model = DistortionModel::kEquidistant;
  to.imu.reset();
  const Eigen::VectorXd change = calibrationChange(to, from);
  EXPECT_TRUE(std::isnan(change[0]));
  EXPECT_EQ(change[8], 0);  // the other camera does
  EXPECT_TRUE(std::isnan(change[28]));
}

}  // namespace
}  // namespace plumbline
