// SPDX-License-Identifier: BSD-3-Clause
// What a comparison reads.
#include "evaluate/compare/compare_calibrations.h"

#include <gtest/gtest.h>

#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

TEST(ReadCompared, AMissingTimeShiftIsUnknown) {
  const TemporaryFolder folder;
  std::string text = kCamchainImuYaml;
  const std::vector<std::string> with = {folder.write("with.yaml", text)};
  EXPECT_TRUE(readCompared(with, {})[0].states_offset);
  for (std::size_t at = text.find("  timeshift_cam_imu:"); at != std::string::npos;
       at = text.find("  timeshift_cam_imu:")) {
    text.erase(at, text.find('\n', at) + 1 - at);
  }
  const TemporaryFolder other;
  const auto without = readCompared({other.write("without.yaml", text)}, {});
  EXPECT_FALSE(without[0].states_offset);
  ASSERT_EQ(without[0].remarks.size(), 1U);
  EXPECT_EQ(without[0].remarks[0].rule, "Time offset");
}

TEST(ReadCompared, ScaleAndMisalignmentOfKalibrsImuAreToldOf) {
  const TemporaryFolder folder;
  const std::vector<std::string> paths = {folder.write("camchain.yaml", kCamchainImuYaml)};
  const std::string gyro =
      "  gyroscopes:\n    M:\n    - [1.01, 0.0, 0.0]\n    - [0.0, 1.0, 0.0]\n"
      "    - [0.0, 0.0, 0.99]\n";
  folder.write("imu.yaml", kImuYaml + gyro);
  const auto distorted = readCompared(paths, {});
  ASSERT_EQ(distorted[0].remarks.size(), 1U);
  EXPECT_EQ(distorted[0].remarks[0].level, VerdictLevel::kCaution);
  folder.write("imu.yaml", kImuYaml);
  EXPECT_TRUE(readCompared(paths, {})[0].remarks.empty());
}

}  // namespace
}  // namespace plumbline
