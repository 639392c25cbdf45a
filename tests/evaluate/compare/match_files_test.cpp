// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "datasets/calibration/export/calibration_export.h"
#include "evaluate/compare/compare_calibrations.h"
#include "evaluate/compare/parameters.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

/// Three cameras, each with a focal length and a place of its own.
Calibration threeCameras() {
  Calibration c;
  for (int i = 0; i < 3; ++i) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(i);
    camera.rostopic = "/" + camera.name + "/image_raw";
    camera.intrinsics.resolution = {752, 480};
    camera.intrinsics.projection = Eigen::Vector4d(450 + i, 450, 370, 240);
    camera.intrinsics.distortion = Eigen::Vector4d::Zero();
    camera.T_C0Ci = Transform(expSO3({0, 0, 0.1 * i}), {0.1 * i, 0, 0});
    c.cameras.push_back(camera);
  }
  c.imu.emplace();
  c.imu->T_SC0 = Transform(expSO3({0.02, -0.01, 1.55}), {-0.02, -0.065, 0.01});
  return c;
}

/// Of these cameras, in this order, named by their places as in Kalibr's file.
ComparedFile camchain(const std::string& label, const std::vector<std::size_t>& places) {
  ComparedFile file;
  file.compared.label = label;
  file.compared.calibration = selectCameras(threeCameras(), places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    file.compared.calibration.cameras[i].name = "cam" + std::to_string(i);
  }
  return file;
}

void expectNoDifference(const std::vector<ComparedFile>& files) {
  std::vector<Calibration> all;
  for (const ComparedFile& file : files) all.push_back(file.compared.calibration);
  for (const ComparedParameter& p : comparedParameters(all)) {
    if (!p.difference[1]) continue;
    EXPECT_NEAR(*p.difference[1], 0, 1e-12) << p.name;
  }
}

TEST(MatchFiles, AnotherOrderOfCamerasIsNoDifferenceAndIsSaid) {
  for (const std::vector<std::size_t>& order :
       {std::vector<std::size_t>{0, 2, 1}, {1, 2, 0}, {2, 1, 0}}) {
    std::vector<ComparedFile> files{camchain("a", {0, 1, 2}), camchain("b", order)};
    const auto findings = matchToFirst(files);
    expectNoDifference(files);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].rule, "Cameras of b");
    EXPECT_EQ(findings[0].level, VerdictLevel::kGood);
    EXPECT_THAT(findings[0].evidence, HasSubstr("another order"));
    ComparisonRecord record;
    record.verdict.findings = findings;
    EXPECT_THAT(comparisonSummary(record), HasSubstr("Cameras of b: the file has another order"));
  }
  std::vector<ComparedFile> same{camchain("a", {0, 1, 2}), camchain("b", {0, 1, 2})};
  EXPECT_TRUE(matchToFirst(same).empty());
}

TEST(MatchFiles, OneCameraIsComparedWithItselfWhicheverFileComesFirst) {
  for (const bool first : {true, false}) {
    std::vector<ComparedFile> files{camchain("one", {1}), camchain("all", {0, 1, 2})};
    if (!first) std::swap(files[0], files[1]);
    const auto findings = matchToFirst(files);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_THAT(findings[0].evidence, HasSubstr("cam1 (/cam1/image_raw)"));
    for (const ComparedFile& file : files) {
      EXPECT_EQ(file.compared.calibration.cameras[0].intrinsics.projection[0], 451);
    }
    expectNoDifference(files);
    EXPECT_LT(
        boxminus(files[0].compared.calibration.imu->T_SC0, files[1].compared.calibration.imu->T_SC0)
            .norm(),
        1e-12);
  }
}

TEST(MatchFiles, ACovarianceFollowsTheNames) {
  std::vector<ComparedFile> files{camchain("one", {1}), camchain("ours", {0, 1})};
  files[1].extras.cameras = ParameterCovariance{{"cam0.fu", "cam1.fu", "T_C0C1.tx"}, {}, {}};
  (void)matchToFirst(files);
  EXPECT_EQ(files[1].compared.calibration.cameras[0].name, "cam0");
  EXPECT_EQ(files[1].extras.cameras->names[1], "cam0.fu");
  EXPECT_NE(files[1].extras.cameras->names[0], "cam0.fu");
}

TEST(MatchFiles, AnOrderThatNothingTellsIsCaution) {
  std::vector<ComparedFile> files{camchain("a", {0, 1}), camchain("b", {0, 1})};
  for (std::size_t i = 0; i < 2; ++i) {
    files[0].compared.calibration.cameras[i].rostopic.clear();
    files[0].compared.calibration.cameras[i].name = i == 0 ? "left" : "right";
  }
  const auto findings = matchToFirst(files);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].level, VerdictLevel::kCaution);
  EXPECT_THAT(findings[0].evidence, HasSubstr("neither rostopic nor names"));
}

TEST(MatchFiles, WithoutACommonCameraNothingIsCompared) {
  std::vector<ComparedFile> files{camchain("a", {0}), camchain("b", {1})};
  EXPECT_THROW(matchToFirst(files), InputError);
}

}  // namespace
}  // namespace plumbline
