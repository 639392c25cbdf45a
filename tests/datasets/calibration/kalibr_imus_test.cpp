// SPDX-License-Identifier: BSD-3-Clause
// What Kalibr's and OpenVINS' files state of an IMU.
#include <string>

#include <gtest/gtest.h>

#include "datasets/calibration/kalibr/run.h"
#include "datasets/session/imu.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

TEST(KalibrImus, ScaleAndMisalignmentAreReadForComparingOnly) {
  const std::string text = std::string(kImuYaml).replace(std::string(kImuYaml).find("calibrated"),
                                                         10, "scale-misalignment") +
                           "  gyroscopes:\n    M:\n    - [1.01, 0.0, 0.0]\n    - [0.0, 1.0, 0.0]\n"
                           "    - [0.0, 0.0, 0.99]\n";
  const TemporaryFolder folder;
  const std::string path = folder.write("imu.yaml", text);
  const KalibrImuFile file = readKalibrImus(path);
  EXPECT_TRUE(file.wrapped);
  EXPECT_EQ(file.imus[0].model, "scale-misalignment");
  EXPECT_EQ((*file.imus[0].gyro_M)(0, 0), 1.01);
  EXPECT_TRUE(file.imus[0].isDistorted());
  EXPECT_FALSE(readKalibrImus(folder.write("plain.yaml", kImuYaml)).imus[0].isDistorted());
  EXPECT_FALSE(file.imus[0].accel_M);
  EXPECT_EQ(faultOf([&] { (void)readImuDescription(path); }), InputFault::kUnsupported);
}

TEST(KalibrImus, EveryMatrixCountsWhateverTheModelIsCalled) {
  const TemporaryFolder folder;
  const auto fault = [&](const std::string& more) {
    const std::string path = folder.write("imu.yaml", kImuYaml + more);
    return faultOf([&] { (void)readImuDescription(path); });
  };
  const std::string first = "    - [1.0, 0.0, 0.0]\n", third = "    - [0.0, 0.0, 1.0]\n";
  EXPECT_EQ(fault("  gyroscopes:\n    M:\n" + first + "    - [0.0, 1.0, 0.0]\n" + third),
            std::nullopt);
  // A, the rates' dependence on acceleration [rad/s per m/s^2], is zero in an IMU without faults.
  const std::string zeros = "    - [0.0, 0.0, 0.0]\n", sensitivity = "  gyroscopes:\n    A:\n";
  EXPECT_EQ(fault(sensitivity + zeros + zeros + zeros), std::nullopt);
  EXPECT_EQ(fault(sensitivity + first + "    - [0.0, 1.0, 0.0]\n" + third),
            InputFault::kUnsupported);
  for (const char* matrix : {"A", "C_gyro_i", "M"}) {
    const std::string key = std::string("  gyroscopes:\n    ") + matrix + ":\n";
    EXPECT_EQ(fault(key + first + "    - [0.0, 0.9, 0.1]\n" + third), InputFault::kUnsupported);
    EXPECT_EQ(fault(key + "    - [1.0, 0.0]\n    - [0.0, 1.0]\n"), InputFault::kBadNumber);
  }
}

// OpenVINS' own files say "kalibr" and the identity; what they estimated would be lost.
TEST(KalibrImus, MatricesOfOpenVinsCountToo) {
  const TemporaryFolder folder;
  const std::string first = "    - [1.0, 0.0, 0.0]\n", third = "    - [0.0, 0.0, 1.0]\n";
  for (const char* model : {"calibrated", "kalibr", "rpng"}) {
    std::string text = "%YAML:1.0\n\n" + std::string(kImuYaml);
    text.replace(text.find("calibrated"), 10, model);
    const auto fault = [&](const char* key, const char* second) {
      const std::string rows = std::string("  ") + key + ":\n" + first + second + third;
      const std::string path = folder.write("imu.yaml", text + rows);
      return faultOf([&] { (void)readImuDescription(path); });
    };
    for (const char* key : {"Tw", "R_IMUtoGYRO", "Ta", "R_IMUtoACC"}) {
      EXPECT_EQ(fault(key, "    - [0.0, 1.0, 0.0]\n"), std::nullopt) << model << key;
      EXPECT_EQ(fault(key, "    - [0.0, 0.99, 0.0]\n"), InputFault::kUnsupported) << model << key;
    }
    EXPECT_EQ(fault("Tg", "    - [0.0, 0.0, 0.0]\n"), InputFault::kUnsupported) << model;
  }
}

// The samples are in the IMU's own frame, as results are.
TEST(KalibrImus, TheBodyOfEurocDoesNotMatter) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "imu.yaml", std::string(kImuYaml) +
                      "  T_BS:\n    rows: 4\n    cols: 4\n"
                      "    data: [0, -1, 0, 0.1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n");
  EXPECT_EQ(readImuDescription(path).noise.gyro_density, 0.00017);
}

TEST(KalibrImus, NoneIsLeftOut) {
  std::string third = kImuYaml;
  const std::string text = kImuYaml + third.replace(third.find("imu0"), 4, "imu2");
  const TemporaryFolder folder;
  const std::string path = folder.write("imu.yaml", text);
  EXPECT_EQ(faultOf([&] { (void)readKalibrImus(path); }), InputFault::kMissingKey);
}

}  // namespace
}  // namespace plumbline
