// SPDX-License-Identifier: BSD-3-Clause
// The time shift of each camera in a camchain.
#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/calibration_reader.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

std::string withSecondCamera(const std::string& shift) {
  std::string second = kCamchainImuYaml;
  second.replace(second.find("cam0"), 4, "cam1");
  second.replace(second.find("-0.0125"), 7, shift);
  return kCamchainImuYaml + second;
}

TEST(KalibrTimeShifts, EachIsKeptAndTheMeanIsThere) {
  const TemporaryFolder folder;
  const auto imu = *readCalibration(folder.write("chain", withSecondCamera("-0.0135"))).imu;
  EXPECT_EQ(imu.timeOffset(), -0.0125);  // camera 0's
  EXPECT_DOUBLE_EQ(meanTimeOffset(imu), -0.013);
  EXPECT_TRUE(hasOwnOffset(imu.time_offsets, 1));
  EXPECT_EQ(imu.timeOffset(1), -0.0135);
}

TEST(KalibrTimeShifts, EqualOnesAreOneOffset) {
  const TemporaryFolder folder;
  const auto imu = *readCalibration(folder.write("chain", withSecondCamera("-0.0125"))).imu;
  EXPECT_FALSE(haveOwnOffsets(imu.time_offsets));
  EXPECT_EQ(meanTimeOffset(imu), -0.0125);
}

// A camera that was not calibrated for time has the shift of the first one that was, not none.
TEST(KalibrTimeShifts, ACameraWithoutOneTakesThatOfAnother) {
  const TemporaryFolder folder;
  const auto without = [](const char* camera) {
    std::string text = withSecondCamera("-0.0135");
    const std::size_t at = text.find("  timeshift", text.find(camera));
    return text.erase(at, text.find('\n', at) + 1 - at);
  };
  const std::string second = folder.write("second.yaml", without("cam1"));
  const std::string first = folder.write("first.yaml", without("cam0"));
  const auto imu = *readCalibration(second).imu;
  EXPECT_EQ(imu.timeOffset(1), -0.0125);
  EXPECT_FALSE(hasOwnOffset(imu.time_offsets, 1));
  EXPECT_EQ(readCalibration(first).imu->timeOffset(), -0.0135);
  EXPECT_TRUE(CalibrationFile(first).statesTimeOffset() &&
              CalibrationFile(second).statesTimeOffset());
  std::string neither = kCamchainImuYaml;
  neither.erase(neither.find("  timeshift"));
  EXPECT_FALSE(CalibrationFile(folder.write("neither.yaml", neither)).statesTimeOffset());
}

}  // namespace
}  // namespace plumbline
