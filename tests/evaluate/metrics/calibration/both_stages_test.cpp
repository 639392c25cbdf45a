// SPDX-License-Identifier: BSD-3-Clause
// Deviations of T_SC0 and the time offset, as every job states them.
#include "evaluate/metrics/calibration/both_stages.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/batch/two_stages.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

/// A camera-IMU stage of a second camera with an offset of its own; deviations 1 to 8.
CalibrationRecord ofTheImuAlone() {
  CalibrationRecord record;
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.cameras.resize(2);
  stage.cameras[0].name = "cam0";
  stage.cameras[1].name = "cam1";
  stage.imu.time_offsets = {{1e-3}, {2e-3, true}};
  ParameterCovariance& covariance = stage.summary.covariance;
  covariance.names = {"T_SC0.tx", "T_SC0.ty", "T_SC0.tz",    "T_SC0.rx",
                      "T_SC0.ry", "T_SC0.rz", "time_offset", "time_offset.cam1"};
  covariance.units.assign(8, "");
  covariance.matrix = Eigen::VectorXd::LinSpaced(8, 1, 8).cwiseAbs2().asDiagonal();
  return record;
}

TEST(StatedDeviations, ThoseOfTheTestsStandInWhereTheStagesHaveNone) {
  CalibrationRecord record = ofTheImuAlone();
  EXPECT_EQ(statedDeviations(record).at("T_SC0.ty").std, 2) << "formal";
  FaultDiagnosis& faults = record.camera_imu->faults.emplace();
  faults.robust_std << 10, 20, 30, 40, 50, 0, 70;
  faults.robust_dof = Eigen::VectorXd::Constant(7, 5);
  faults.robust_dof->head<1>().setZero();
  StatedDeviations stated = statedDeviations(record);
  ASSERT_EQ(stated.size(), 8U);
  EXPECT_EQ(stated.at("T_SC0.ty").std, 20);
  EXPECT_EQ(stated.at("T_SC0.ty").dof, 5);
  EXPECT_EQ(stated.at("T_SC0.tx").std, 1) << "no degree of freedom";
  EXPECT_EQ(stated.at("T_SC0.rz").std, 6) << "nothing scattered";
  EXPECT_EQ(stated.at("time_offset.cam1").std, 8) << "formal, for it is not among them";
  record.camera_imu->summary.robust_std = Eigen::VectorXd::Constant(7, 9);
  stated = statedDeviations(record);
  EXPECT_EQ(stated.at("time_offset").std, 9) << "through both stages";
  EXPECT_TRUE(std::isinf(stated.at("time_offset").dof));
}

TEST(ConvergedCameraImu, HoldsWhatTheCamerasLeaveOpen) {
  SimulationOptions simulation;
  simulation.duration_s = 12;
  simulation.camera_rate_hz = 10;
  const Session session = simulateSession(simulatedRig("euroc"), simulation).session;
  CameraStageOptions camera;
  camera.target = TargetMode::kGiven;
  const auto cameras = calibrateCameras(session, camera);
  ASSERT_TRUE(cameras);
  CameraImuOptions options;
  const auto alone = convergedCameraImu(session, cameras->cameras, options);
  const auto both = convergedCameraImu(session, cameras->cameras, options, &*cameras);
  ASSERT_TRUE(alone && both && both->faults);
  EXPECT_FALSE(alone->summary.robust_std);
  ASSERT_TRUE(both->summary.robust_std && both->summary.robust_dof);
  const auto stages = robustDeviationsOfBothStages(*cameras, *both);
  ASSERT_TRUE(stages);
  EXPECT_EQ(*both->summary.robust_std, stages->std);
  EXPECT_TRUE((both->summary.robust_std->array() >= both->faults->robust_std.array()).all());
  options.max_iterations = 1;
  const auto stopped = convergedCameraImu(session, cameras->cameras, options);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.failure().code, FailureCode::kCameraImuNotConverged);
}

}  // namespace
}  // namespace plumbline
