// SPDX-License-Identifier: BSD-3-Clause
// A good calibration with one mistake: lint names that mistake and nothing else.
#include "evaluate/lint/lint.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluate/lint/lint_cases.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

std::vector<LintedCalibration> goodFiles() {
  const SimulatedRig rig = simulatedRig("euroc");
  return {repeatOf(rig, "first.yaml"), repeatOf(rig, "second.yaml", 3),
          repeatOf(rig, "third.yaml", -4)};
}

TEST(Lint, RepeatsOfACalibrationAreClean) {
  for (const char* const name : {"euroc", "tumvi", "d435i"}) {
    const SimulatedRig rig = simulatedRig(name);
    const std::vector<LintedCalibration> files{repeatOf(rig, "a"), repeatOf(rig, "b", 5),
                                               repeatOf(rig, "c", -5)};
    EXPECT_EQ(rulesOf(lintCalibrations(files)), "") << name;
  }
}

// ---- mistakes that one file shows

std::vector<LintCase> aloneCases() {
  return {
      {"lever arm in millimetres", [](Calibration& c) { c.imu->T_SC0.t *= 1000; },
       "Millimetres for metres", "T_cam_imu"},
      {"baseline in millimetres", [](Calibration& c) { c.cameras[1].T_C0Ci.t *= 1000; },
       "Millimetres for metres", "T_cn_cnm1"},
      {"impossible lever arm",
       [](Calibration& c) {
         c.imu->T_SC0.t = {0, 0, 2.5};
       },
       "Impossible lever arm", "T_cam_imu"},
      {"offset in milliseconds", [](Calibration& c) { c.imu->time_offsets[0].s *= 1000; },
       "Milliseconds for seconds", "timeshift_cam_imu"},
      {"intrinsics of half the image",
       [](Calibration& c) { c.cameras[1].intrinsics.projection *= 0.5; },
       "Resolution and principal point", "cam1"},
      {"resolution of half the image",
       [](Calibration& c) {
         c.cameras[0].intrinsics.resolution = {376, 240};
       },
       "Resolution and principal point", "cam0"},
      {"width and height exchanged",
       [](Calibration& c) {
         c.cameras[0].intrinsics.resolution = {480, 752};
       },
       "Resolution and principal point", "width and height"},
      {"accelerometer's density in micro-g",
       [](Calibration& c) { c.imu->noise.accel_density = 200; }, "Noise densities",
       "accelerometer_noise_density"},
  };
}

TEST(Lint, AFileAloneShowsImpossibleValues) {
  for (const LintCase& fault : aloneCases()) {
    std::vector<LintedCalibration> files{repeatOf(simulatedRig("euroc"), "bad.yaml")};
    fault.inject(files[0].calibration);
    const auto found = lintCalibrations(files);
    ASSERT_EQ(found.size(), 1U) << fault.what << "\n" << rulesOf(found);
    EXPECT_EQ(found[0].rule, fault.rule) << fault.what;
    EXPECT_THAT(found[0].evidence, HasSubstr("bad.yaml"));
    EXPECT_THAT(found[0].advice, AllOf(HasSubstr("bad.yaml"), HasSubstr(fault.field)));
    EXPECT_GT(found[0].value, found[0].threshold);
  }
}

TEST(Lint, AMistakeOfOneFileIsNotHeldAgainstTheOthers) {
  for (const LintCase& fault : aloneCases()) {
    auto files = goodFiles();
    fault.inject(files[1].calibration);
    const auto found = lintCalibrations(files);
    ASSERT_EQ(found.size(), 1U) << fault.what << "\n" << rulesOf(found);
    EXPECT_THAT(found[0].advice, HasSubstr("second.yaml")) << fault.what;
  }
}

TEST(Lint, WithinOneDeviceTheImuIsNear) {
  LintedCalibration file = repeatOf(simulatedRig("d435i"), "a.yaml");
  file.calibration.imu->T_SC0.t = {0.12, 0, 0};
  EXPECT_EQ(rulesOf(lintCalibrations({&file, 1})), "");  // an IMU of a robot may be there
  file.calibration.cameras[0].rostopic = "/camera/infra1/image_rect_raw";
  file.calibration.imu->rostopic = "/imu/data";
  EXPECT_EQ(rulesOf(lintCalibrations({&file, 1})), "");
  file.calibration.imu->rostopic = "/camera/imu";
  const auto found = lintCalibrations({&file, 1});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].rule, "Impossible lever arm");
  EXPECT_THAT(found[0].evidence, HasSubstr("12.0 cm"));
}

// ---- mistakes that only other files show

std::vector<LintCase> togetherCases() {
  return {
      {"T_cam_imu inverted", invertImu, "Inverted transform", "T_cam_imu"},
      {"offset negated", negateOffset, "Flipped time offset", "timeshift_cam_imu"},
      {"cameras exchanged", swapCameras, "Order of cameras", "cam0 and cam1"},
      {"baseline inverted", invertBaseline, "Inverted baseline", "T_cn_cnm1"},
      {"discrete densities", makeDensitiesDiscrete, "Discrete noise densities", "update_rate"},
      {"gyroscope's density in degrees",
       [](Calibration& c) { c.imu->noise.gyro_density *= 180 / std::acos(-1.0); },
       "Degrees for radians", "gyroscope_noise_density"},
      {"a lever arm that is elsewhere",
       [](Calibration& c) { c.imu->T_SC0.t += Eigen::Vector3d(0.1, 0.05, 0); },
       "Impossible lever arm", "T_cam_imu"},
  };
}

TEST(Lint, OfThreeFilesTheMinorityIsNamed) {
  for (const LintCase& fault : togetherCases()) {
    auto files = goodFiles();
    fault.inject(files[1].calibration);
    const auto found = lintCalibrations(files);
    ASSERT_EQ(found.size(), 1U) << fault.what << "\n" << rulesOf(found);
    EXPECT_EQ(found[0].rule, fault.rule) << fault.what;
    EXPECT_THAT(found[0].advice, AllOf(HasSubstr("second.yaml"), HasSubstr(fault.field)));
    EXPECT_THAT(found[0].advice, Not(HasSubstr("first.yaml"))) << fault.what;
  }
}

TEST(Lint, AnotherOrderOfThreeCamerasIsNamed) {
  auto files = goodFiles();
  files.pop_back();
  for (LintedCalibration& file : files) {
    CameraCalibration third = file.calibration.cameras[1];
    third.name = "cam2";
    third.T_C0Ci = Transform(expSO3({0, 0.5, 0}), {0.05, 0.1, 0});
    file.calibration.cameras.push_back(third);
  }
  EXPECT_EQ(rulesOf(lintCalibrations(files)), "");
  Calibration& turned = files[1].calibration;
  std::swap(turned.cameras[1], turned.cameras[2]);
  const auto found = lintCalibrations(files);
  ASSERT_EQ(found.size(), 1U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Order of cameras");
  EXPECT_THAT(found[0].evidence, HasSubstr("cam0, cam1, cam2 of second.yaml are the cameras of"));
}

TEST(Lint, TheCameraOfAnotherResolutionIsNamed) {
  auto files = goodFiles();
  files[1].calibration.cameras[1].intrinsics.resolution = {960, 600};
  const auto found = lintCalibrations(files);
  ASSERT_EQ(found.size(), 1U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Resolution and principal point");
  EXPECT_THAT(found[0].evidence, HasSubstr("of cam1 (960x600 in second.yaml)"));
}

// Of two ratios near the bound, one within it and its inverse not: the order of files is no matter.
TEST(Lint, AResolutionIsFoundWhereverItsFileStands) {
  for (const std::size_t at : {0U, 1U, 2U}) {
    auto files = goodFiles();
    files[at].calibration.cameras[0].intrinsics.resolution = {752 * 5 / 4, 480 * 5 / 4};
    const auto found = lintCalibrations(files);
    ASSERT_EQ(found.size(), 1U) << at << rulesOf(found);
    EXPECT_EQ(found[0].rule, "Resolution and principal point");
    EXPECT_THAT(found[0].evidence, HasSubstr("of cam0 (940x600 in " + files[at].name)) << at;
  }
}

TEST(Lint, OfTwoFilesEitherMayBeWrong) {
  for (const LintCase& fault : togetherCases()) {
    if (std::string(fault.rule) == "Impossible lever arm") continue;  // two cannot tell
    auto files = goodFiles();
    files.pop_back();
    fault.inject(files[1].calibration);
    const auto found = lintCalibrations(files);
    ASSERT_EQ(found.size(), 1U) << fault.what << "\n" << rulesOf(found);
    EXPECT_EQ(found[0].rule, fault.rule) << fault.what;
    EXPECT_THAT(found[0].advice, HasSubstr("second.yaml"));
  }
}

TEST(Lint, AnInversionShowsWithoutRotation) {
  // The D435i's IMU and cameras have the same axes: only the lever arm tells.
  std::vector<LintedCalibration> files{repeatOf(simulatedRig("d435i"), "a"),
                                       repeatOf(simulatedRig("d435i"), "b", 2)};
  files[1].calibration.imu->T_SC0 = files[1].calibration.imu->T_SC0.inverse();
  const auto found = lintCalibrations(files);
  ASSERT_EQ(found.size(), 1U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Inverted transform");
}

TEST(Lint, UnknownNoiseIsNotCompared) {
  auto files = goodFiles();
  files[1].calibration.imu->noise.gyro_density *= 180 / std::acos(-1.0);
  files[1].noise_known = false;
  EXPECT_EQ(rulesOf(lintCalibrations(files)), "");
}

}  // namespace
}  // namespace plumbline
