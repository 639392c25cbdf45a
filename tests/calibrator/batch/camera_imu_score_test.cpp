// SPDX-License-Identifier: BSD-3-Clause
// Scoring a given camera-IMU calibration: the calibration stays, everything else moves.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

struct Case {
  SimulatedSession simulated = test::simulate(test::noisyRecording(3));
  CameraImuOptions options = test::matchedOptions(simulated, 0.2);

  Result<CameraImuStageResult> score(const ImuCalibration& imu) const {
    return scoreCameraImu(simulated.session, simulated.truth.cameras, imu, options);
  }
};

TEST(CameraImuScore, OfTheCalibratedResultIsItsOwn) {
  const Case c;
  const auto calibrated =
      calibrateCameraImu(c.simulated.session, c.simulated.truth.cameras, c.options);
  ASSERT_TRUE(calibrated);
  const auto scored = c.score(calibrated->imu);
  ASSERT_TRUE(scored);
  EXPECT_TRUE(scored->summary.converged);
  EXPECT_EQ(scored->frames.size(), calibrated->frames.size());
  const double rmse = calibrated->summary.reprojection.rmse_px;
  EXPECT_NEAR(scored->summary.reprojection.rmse_px, rmse, 1e-7 * rmse);
  // The whitening is taken at the states of another step: its change of the cost is of second
  // order.
  EXPECT_NEAR(scored->summary.cost, calibrated->summary.cost, 1e-5 * calibrated->summary.cost);
  // Nothing of the calibration has moved, to the last bit.
  EXPECT_EQ(scored->imu.T_SC0.R, calibrated->imu.T_SC0.R);
  EXPECT_EQ(scored->imu.T_SC0.t, calibrated->imu.T_SC0.t);
  EXPECT_EQ(scored->imu.timeOffset(), calibrated->imu.timeOffset());
  EXPECT_FALSE(scored->imu.T_SC0_std);
  EXPECT_EQ(scored->summary.covariance.matrix.size(), 0);
  for (std::size_t i = 0; i < scored->states.size(); ++i) {
    EXPECT_LT(boxminus(scored->states[i].T_FS, calibrated->states[i].T_FS).norm(), 1e-5);
  }
}

TEST(CameraImuScore, EveryOtherCalibrationScoresWorse) {
  const Case c;
  const auto calibrated =
      calibrateCameraImu(c.simulated.session, c.simulated.truth.cameras, c.options);
  ASSERT_TRUE(calibrated);
  const double least = calibrated->summary.cost;
  for (int axis = 0; axis < 3; ++axis) {
    ImuCalibration turned = calibrated->imu;
    turned.T_SC0.R = expSO3(kDegree * Eigen::Vector3d::Unit(axis)) * turned.T_SC0.R;
    const auto scored = c.score(turned);
    ASSERT_TRUE(scored) << axis;
    EXPECT_EQ(scored->imu.T_SC0.R, turned.T_SC0.R);
    EXPECT_GT(scored->summary.cost, 1.3 * least) << axis;
  }
  ImuCalibration moved = calibrated->imu;
  moved.T_SC0.t.x() += 0.05;
  const auto further = c.score(moved);
  ASSERT_TRUE(further);
  EXPECT_GT(further->summary.cost, 1.05 * least);
  ImuCalibration late = calibrated->imu;
  late.time_offsets[0].s += 0.01;
  const auto later = c.score(late);
  ASSERT_TRUE(later);
  EXPECT_EQ(later->imu.timeOffset(), late.timeOffset());
  EXPECT_GT(later->summary.cost, 1.5 * least);
}

TEST(CameraImuScore, TheCalibrationIsTheBestThatScores) {
  // The score's minimum over T_SC0 and the offset is the calibration: along every direction the
  // cost rises from it, by half a unit at one standard deviation (others held: at least that).
  const Case c;
  const auto calibrated =
      calibrateCameraImu(c.simulated.session, c.simulated.truth.cameras, c.options);
  ASSERT_TRUE(calibrated);
  const auto base = c.score(calibrated->imu);
  ASSERT_TRUE(base);
  for (int axis = 0; axis < 7; ++axis) {
    for (const double side : {-3.0, 3.0}) {
      ImuCalibration moved = calibrated->imu;
      if (axis < 6) {
        const Vector6d step = side * (*moved.T_SC0_std)[axis] * Vector6d::Unit(axis);
        moved.T_SC0 = boxplus(moved.T_SC0, step);
      } else {
        moved.time_offsets[0].s += side * *moved.time_offset_std_s;
      }
      const auto scored = c.score(moved);
      ASSERT_TRUE(scored);
      EXPECT_GT(scored->summary.cost, base->summary.cost + 0.4 * side * side) << axis;
    }
  }
}

TEST(CameraImuScore, InformationAtTheSolutionIsThatOfTheCalibration) {
  Case c;
  c.options.cauchy_px = 0;
  const auto calibrated =
      calibrateCameraImu(c.simulated.session, c.simulated.truth.cameras, c.options);
  ASSERT_TRUE(calibrated);
  EXPECT_TRUE(c.score(calibrated->imu)->summary.covariance.names.empty());
  c.options.score_information_px = 0;
  const auto scored = c.score(calibrated->imu);
  ASSERT_TRUE(scored);
  const ParameterCovariance& own = calibrated->summary.covariance;
  const ParameterCovariance& told = scored->summary.covariance;
  EXPECT_EQ(told.names, own.names);
  EXPECT_EQ(told.units, own.units);
  const Eigen::VectorXd std = own.standardDeviations();
  for (Eigen::Index i = 0; i < std.size(); ++i) {
    for (Eigen::Index k = 0; k < std.size(); ++k) {
      EXPECT_NEAR(told.matrix(i, k), own.matrix(i, k), 1e-4 * std[i] * std[k]) << i << k;
    }
  }
  EXPECT_NEAR(scored->summary.entropy_nats, calibrated->summary.entropy_nats, 1e-3);
  // Twice the corners' noise: less is known, by at most log 2 for each of the seven parameters.
  c.options.pixel_sigma *= 2;
  const auto noisier = c.score(calibrated->imu);
  ASSERT_TRUE(noisier);
  EXPECT_GT(noisier->summary.entropy_nats, scored->summary.entropy_nats + 0.1);
  EXPECT_LT(noisier->summary.entropy_nats, scored->summary.entropy_nats + 7 * std::log(2.0));
}

TEST(CameraImuScore, InformationListsTheSameWhereCamerasHaveTheirOwnOffsets) {
  Case c;
  c.options.score_information_px = 0;
  ImuCalibration imu = *c.simulated.truth.imu;
  const auto shared = c.score(imu);
  imu.time_offsets = {{imu.timeOffset()}, {imu.timeOffset() + 1e-7, true}};
  const auto own = c.score(imu);
  ASSERT_TRUE(shared && own);
  ASSERT_EQ(shared->summary.covariance.names.size(), 7U);
  EXPECT_EQ(own->summary.covariance.names, shared->summary.covariance.names);
  EXPECT_NEAR(own->summary.entropy_nats, shared->summary.entropy_nats, 1e-2);
}

TEST(CameraImuScore, HoldsTheOffsetsOfEachCamera) {
  const Case c;
  ImuCalibration imu = *c.simulated.truth.imu;
  imu.time_offsets = {{imu.timeOffset()}, {imu.timeOffset() + 0.004, true}};
  const auto together = c.score(*c.simulated.truth.imu);
  const auto apart = c.score(imu);
  ASSERT_TRUE(together && apart);
  for (const std::size_t camera : {0U, 1U})
    EXPECT_EQ(apart->imu.timeOffset(camera), imu.timeOffset(camera));
  EXPECT_GT(apart->summary.per_camera[1].rmse_px, 1.5 * together->summary.per_camera[1].rmse_px);
}

TEST(CameraImuScore, NeedsAnImu) {
  Case c;
  c.simulated.session.imu.reset();
  const auto scored = c.score(*c.simulated.truth.imu);
  ASSERT_FALSE(scored);
  EXPECT_EQ(scored.failure().reason(), FailureReason::kNoOverlap);
}

TEST(CameraImuScore, FramesThatSamplesDoNotCoverAndFramesThatNothingJoinsAreToldApart) {
  Case c;
  c.options.max_interval_s = 0.01;  // frames are 50 ms apart
  auto scored = c.score(*c.simulated.truth.imu);
  ASSERT_FALSE(scored);
  EXPECT_EQ(scored.failure().code, FailureCode::kTooFewJoinedFrames);
  EXPECT_EQ(scored.failure().number("joined"), 0);
  EXPECT_GT(scored.failure().number("covered"), 90);
  c.simulated.session.imu->samples.resize(60);  // 0.3 s
  scored = c.score(*c.simulated.truth.imu);
  ASSERT_FALSE(scored);
  EXPECT_EQ(scored.failure().code, FailureCode::kTooFewCoveredFrames);
  EXPECT_LT(scored.failure().number("covered"), 10);
}

TEST(CameraImuScore, AScaleBelowAThousandthOfAPixelIsRefused) {
  Case c;
  c.options.score_information_px = 1e-4;
  EXPECT_THROW((void)c.score(*c.simulated.truth.imu), InputError);
}

}  // namespace
}  // namespace plumbline
