// SPDX-License-Identifier: BSD-3-Clause
// Parameters by the names of a covariance: each with its own value, deviations and spread. Two
// cameras and an IMU by hand; no two numbers are equal.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "report/records/calibration_record.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

std::vector<CameraCalibration> twoCamerasByHand() {
  std::vector<CameraCalibration> cameras(2);
  for (int i = 0; i < 2; ++i) {
    Intrinsics& k = cameras[static_cast<std::size_t>(i)].intrinsics;
    k.projection = Eigen::Vector4d(400 + i, 410 + i, 320 + i, 240 + i);
    k.distortion = Eigen::Vector4d(0.1 + i, 0.2 + i, 0.3 + i, 0.4 + i);
  }
  cameras[0].name = "left";  // the other one goes by its place
  cameras[1].T_C0Ci = Transform(expSO3({0.01, 0.02, 0.03}), {0.11, 0.12, 0.13});
  return cameras;
}

/// A camera-IMU stage whose covariance has these names, with deviations 1, 2, 3, ...
CalibrationRecord recordWith(const std::vector<std::string>& names) {
  CalibrationRecord record;
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.cameras = twoCamerasByHand();
  // A quarter turn about z: as a rotation vector (0, 0, pi / 2).
  stage.imu.T_SC0 = Transform(expSO3({0, 0, 90 * kDegree}), {0.5, 0.6, 0.7});
  stage.imu.time_offsets = {{0.001}, {0.002, true}};
  ParameterCovariance& covariance = stage.summary.covariance;
  covariance.names = names;
  covariance.units.assign(names.size(), "1");
  const auto n = static_cast<Eigen::Index>(names.size());
  const Eigen::VectorXd std = Eigen::VectorXd::LinSpaced(n, 1, static_cast<double>(n));
  covariance.matrix = std.cwiseAbs2().asDiagonal();
  return record;
}

double valueOf(const std::string& name) {
  const auto estimates = parameterEstimates(recordWith({name}), Stage::kCameraImu);
  EXPECT_EQ(estimates.size(), 1U) << name;
  return estimates.empty() ? 0 : estimates[0].value;
}

TEST(ParameterValues, AreThoseThatTheirNamesMean) {
  EXPECT_EQ(valueOf("left.fu"), 400);
  EXPECT_EQ(valueOf("cam1.fv"), 411);
  EXPECT_EQ(valueOf("cam1.pv"), 241);
  EXPECT_EQ(valueOf("left.p2"), 0.4);
  EXPECT_EQ(valueOf("cam1.k1"), 1.1);
  EXPECT_EQ(valueOf("T_C0C1.ty"), 0.12);
  EXPECT_NEAR(valueOf("T_C0C1.rx"), 0.01, 1e-15);
  EXPECT_EQ(valueOf("T_SC0.tz"), 0.7);
  EXPECT_NEAR(valueOf("T_SC0.rz"), 90 * kDegree, 1e-15);
  EXPECT_EQ(valueOf("time_offset"), 0.001);
  EXPECT_EQ(valueOf("time_offset.cam1"), 0.002);
}

TEST(ParameterValues, NamesOfNothingAreLeftOutAndTheOthersKeepTheirDeviations) {
  const auto estimates =
      parameterEstimates(recordWith({"gravity.x", "T_SC0.tx", "cam0.fu", "T_SC0.wx",
                                     "time_offset.cam2", "time_offset"}),
                         Stage::kCameraImu);
  ASSERT_EQ(estimates.size(), 2U);
  EXPECT_EQ(estimates[0].name, "T_SC0.tx");
  EXPECT_DOUBLE_EQ(estimates[0].std, 2);
  EXPECT_EQ(estimates[1].name, "time_offset");
  EXPECT_DOUBLE_EQ(estimates[1].std, 6);
  EXPECT_TRUE(parameterEstimates(CalibrationRecord(), Stage::kCamera).empty());
}

// The bootstrap lists its parameters in an order of its own.
TEST(ParameterValues, TheSpreadIsFoundByName) {
  CalibrationRecord record = recordWith({"T_SC0.tx", "time_offset", "T_SC0.ty"});
  record.camera_imu_resample.emplace();
  record.camera_imu_resample->names = {"time_offset", "T_SC0.tx"};
  record.camera_imu_resample->std = Eigen::Vector2d(7, 8);
  const auto estimates = parameterEstimates(record, Stage::kCameraImu);
  EXPECT_EQ(estimates[0].resample_std, 8);
  EXPECT_EQ(estimates[1].resample_std, 7);
  EXPECT_EQ(estimates[2].resample_std, std::nullopt);
}

// Of the score tests where the stage has none of its own: T_SC0 and the offset, and no more.
TEST(ParameterValues, RobustDeviationsOfAStageGoBeforeThoseOfItsScoreTests) {
  CalibrationRecord record = recordWith({"T_SC0.tx", "T_SC0.ty", "T_SC0.tz", "T_SC0.rx", "T_SC0.ry",
                                         "T_SC0.rz", "time_offset", "time_offset.cam1"});
  EXPECT_EQ(*shownOffsetStd(record), 7) << "formal";
  FaultDiagnosis& faults = record.camera_imu->faults.emplace();
  faults.robust_std << 10, 20, 30, 40, 50, 60, 70;
  auto estimates = parameterEstimates(record, Stage::kCameraImu);
  EXPECT_EQ(estimates[1].robust_std, 20);
  EXPECT_EQ(estimates[7].robust_std, std::nullopt);
  EXPECT_EQ(*shownOffsetStd(record), 70);
  record.camera_imu->summary.robust_std = Eigen::VectorXd::LinSpaced(8, 100, 800);
  estimates = parameterEstimates(record, Stage::kCameraImu);
  EXPECT_EQ(estimates[1].robust_std, 200);
  EXPECT_EQ(*shownOffsetStd(record), 700);
}

// ---- findings

Finding findingWith(const std::string& rule, VerdictLevel level, const std::string& advice) {
  Finding f;
  f.rule = rule;
  f.level = level;
  f.advice = advice;
  return f;
}

// The gravest first, in the rules' order within a level; what one cure mends stands together, and
// findings without a cure each by itself.
TEST(Findings, AreGatheredByTheirCure) {
  const auto rows = findingsByCure({findingWith("a", VerdictLevel::kGood, ""),
                                    findingWith("b", VerdictLevel::kCaution, "more light"),
                                    findingWith("c", VerdictLevel::kBad, "more light"),
                                    findingWith("d", VerdictLevel::kGood, ""),
                                    findingWith("e", VerdictLevel::kCaution, "more views"),
                                    findingWith("f", VerdictLevel::kCaution, "more light")});
  std::vector<std::string> rules;
  for (const auto& row : rows) {
    std::string text;
    for (const Finding& f : row) text += f.rule;
    rules.push_back(text);
  }
  EXPECT_THAT(rules, ElementsAre("c", "bf", "e", "a", "d"));
}

}  // namespace
}  // namespace plumbline
