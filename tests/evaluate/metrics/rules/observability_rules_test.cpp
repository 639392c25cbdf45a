// SPDX-License-Identifier: BSD-3-Clause
// Every component of what a stage estimates is asked for its standard deviation, in the unit of the
// bound that it is held against.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

using test::cameraRecord;
using test::findingOf;

void setDeviation(StageSummary& summary, const std::vector<std::string>& names,
                  const std::string& large, double small_std, double large_std) {
  auto& covariance = summary.covariance;
  covariance.names = names;
  covariance.units.assign(names.size(), "-");
  const auto n = static_cast<Eigen::Index>(names.size());
  covariance.matrix = small_std * small_std * Eigen::MatrixXd::Identity(n, n);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (names[i] == large) covariance.matrix(k, k) = large_std * large_std;
  }
}

TEST(ObservabilityRules, EitherFocalLengthIsJudgedRelativeToItself) {
  for (const char* large : {"cam0.fu", "cam0.fv"}) {
    CalibrationRecord record = cameraRecord(0.3, 0.8);
    setDeviation(record.camera->summary, {"cam0.fu", "cam0.fv", "cam0.pu", "cam0.pv"}, large, 1e-3,
                 4.5);
    const Finding f = findingOf(judge(record), "Focal length of cam0");
    EXPECT_NEAR(f.value, 0.01, 1e-12) << "4.5 of 450 px";
    EXPECT_EQ(f.level, VerdictLevel::kCaution) << large;
    EXPECT_EQ(f.subject, FindingSubject::kCameras);
  }
}

// In ds and omni fu can be exchanged for xi: fu / (1 + xi) is the scale at the optical axis.
TEST(ObservabilityRules, FocalLengthsOfWideModelsAreThoseAtTheAxis) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  Intrinsics& camera = record.camera->cameras[0].intrinsics;
  camera.projection_model = ProjectionModel::kDs;
  camera.distortion_model = DistortionModel::kNone;
  camera.projection = (Eigen::VectorXd(6) << -0.2, 0.6, 250, 250, 320, 240).finished();
  camera.distortion.resize(0);
  setDeviation(record.camera->summary, {"cam0.xi", "cam0.alpha", "cam0.fu", "cam0.fv"}, "cam0.fu",
               0, 5);
  Eigen::MatrixXd& S = record.camera->summary.covariance.matrix;
  const auto judged = [&] { return findingOf(judge(record), "Focal length of cam0"); };
  EXPECT_NEAR(judged().value, 0.02, 1e-8) << "5 of 250 px";
  // xi moves with fu, by as much of 1 + xi.
  S(0, 0) = 0.016 * 0.016;
  S(0, 2) = S(2, 0) = 0.016 * 5;
  EXPECT_NEAR(judged().value, 0, 1e-5);
  EXPECT_EQ(judged().level, VerdictLevel::kGood);
  S(0, 2) = S(2, 0) = -0.016 * 5;
  EXPECT_NEAR(judged().value, 0.04, 1e-6);
  EXPECT_THAT(judged().evidence, ::testing::HasSubstr("the scale of cam0 at the optical axis"));
}

// In fov it is fu 2 tan(w / 2) / w, whose logarithm changes with w by 1 / sin w - 1 / w.
TEST(ObservabilityRules, TheFocalLengthOfFovIsThatAtTheAxisToo) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  Intrinsics& camera = record.camera->cameras[0].intrinsics;
  camera.distortion_model = DistortionModel::kFov;
  camera.distortion = Eigen::VectorXd::Constant(1, 0.9);
  const double fu = camera.projection[0];
  setDeviation(record.camera->summary, {"cam0.fu", "cam0.w"}, "cam0.fu", 0, 0.02 * fu);
  Eigen::MatrixXd& S = record.camera->summary.covariance.matrix;
  EXPECT_NEAR(findingOf(judge(record), "Focal length of cam0").value, 0.02, 1e-7);
  const double w_std = 0.02 / (1 / std::sin(0.9) - 1 / 0.9);
  S(1, 1) = w_std * w_std;
  S(0, 1) = S(1, 0) = -0.02 * fu * w_std;
  EXPECT_NEAR(findingOf(judge(record), "Focal length of cam0").value, 0, 1e-5);
}

TEST(ObservabilityRules, EveryComponentBetweenCamerasIsJudged) {
  const std::vector<std::string> names{"T_C0C1.tx", "T_C0C1.ty", "T_C0C1.tz", "T_C0C2.tx",
                                       "T_C0C2.ty", "T_C0C2.tz", "T_C0C1.rx"};
  for (const std::string& large : names) {
    CalibrationRecord record = cameraRecord(0.3, 0.8);
    record.camera->cameras.resize(3, record.camera->cameras[0]);
    setDeviation(record.camera->summary, names, large, 1e-5, 0.003);
    const Finding f = findingOf(judge(record), "Translation between cameras");
    const bool rotation = large.ends_with("rx");
    EXPECT_EQ(f.level, rotation ? VerdictLevel::kGood : VerdictLevel::kCaution) << large;
    EXPECT_NEAR(f.value, rotation ? 1e-5 : 0.003, 1e-12) << large;
  }
}

// A lens that is decentred turns what stands on its camera's poses; by how much counts in the
// deviation that is stated of it.
TEST(ObservabilityRules, ADecentredLensCountsByTheRotationThatTurnsWithIt) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  CameraStageResult& stage = *record.camera;
  stage.decentring = {{"cam0", {6e-4, 0}, {2e-5, 2e-5}, 400, 13, {3e-4, 0, 0}}};
  for (const Finding& f : judge(record).findings) EXPECT_NE(f.rule, "Decentring of cam0");
  stage.cameras.resize(2, stage.cameras[0]);
  stage.cameras[1].name = "cam1";
  stage.decentring.push_back(stage.decentring[0]);
  stage.decentring[1].camera = "cam1";
  stage.decentring[1].turn *= 0.1;
  setDeviation(stage.summary, {"T_C0C1.rx", "T_C0C1.ry", "T_C0C1.rz"}, "T_C0C1.ry", 1e-6, 1e-4);
  const auto judged = [&](const char* rule) { return findingOf(judge(record), rule); };
  EXPECT_NEAR(judged("Decentring of cam0").value, 3, 1e-12);
  EXPECT_EQ(judged("Decentring of cam0").level, VerdictLevel::kCaution);
  EXPECT_EQ(judged("Decentring of cam0").subject, FindingSubject::kCameras);
  EXPECT_EQ(judged("Decentring of cam1").level, VerdictLevel::kGood);
  // Without significance nobody knows; where it would not matter it need not be known.
  for (Decentring& d : stage.decentring) d.f = 5;
  EXPECT_TRUE(isNotJudged(judged("Decentring of cam0")));
  EXPECT_FALSE(isNotJudged(judged("Decentring of cam1")));
}

TEST(ObservabilityRules, EveryComponentOfTheImusPoseIsJudgedInItsUnit) {
  const std::vector<std::string> names{"T_SC0.tx", "T_SC0.ty", "T_SC0.tz",   "T_SC0.rx",
                                       "T_SC0.ry", "T_SC0.rz", "time_offset"};
  // 6 mm and 0.3 degrees and 1 ms are each beyond the bound of caution.
  const auto judged = [&](const std::string& large, double std) {
    CalibrationRecord record = cameraRecord(0.3, 0.8);
    record.camera_imu.emplace();
    setDeviation(record.camera_imu->summary, names, large, 1e-6, std);
    return judge(record);
  };
  for (const std::string& large : names) {
    const bool arm = large.starts_with("T_SC0.t"), turn = large.starts_with("T_SC0.r");
    const double std = arm ? 0.006 : turn ? 0.3 * std::numbers::pi / 180 : 1e-3;
    const Verdict verdict = judged(large, std);
    const Finding lever = findingOf(verdict, "Lever arm"),
                  rotation = findingOf(verdict, "Rotation between camera and IMU"),
                  offset = findingOf(verdict, "Time offset");
    EXPECT_EQ(lever.level, arm ? VerdictLevel::kCaution : VerdictLevel::kGood) << large;
    EXPECT_EQ(rotation.level, turn ? VerdictLevel::kCaution : VerdictLevel::kGood) << large;
    EXPECT_EQ(offset.level, !arm && !turn ? VerdictLevel::kCaution : VerdictLevel::kGood) << large;
    if (arm) {
      EXPECT_NEAR(lever.value, 0.006, 1e-12) << "in m";
    }
    if (turn) {
      EXPECT_NEAR(rotation.value, 0.3, 1e-12) << "in degrees";
    }
    if (!arm && !turn) {
      EXPECT_NEAR(offset.value, 1, 1e-12) << "in ms";
    }
  }
}

}  // namespace
}  // namespace plumbline
