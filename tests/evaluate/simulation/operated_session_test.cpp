// SPDX-License-Identifier: BSD-3-Clause
// The closed loop of guide and person: suggestions are followed and end; the recording is one that
// a calibration understands; the same seeds give the same session.
#include "evaluate/simulation/operated_session.h"

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/simulate/operator/rig_sensors.h"

namespace plumbline {
namespace {

OperatedOptions options(double duration_s) {
  OperatedOptions o;
  o.simulation.duration_s = duration_s;
  o.trajectories = 2;
  return o;
}

TEST(OperatedSession, IsGuidedUntilTheTrajectoriesAreDone) {
  const SimulatedRig rig = simulatedRig("d435i");
  const OperatedSession s = recordGuided(rig, options(120));
  EXPECT_TRUE(s.finished);
  EXPECT_GT(s.camera_s, 3);
  EXPECT_GT(s.camera_imu_s, 2 * 4) << "two trajectories, each as fast as the limits allow";
  EXPECT_LT(s.camera_s + s.camera_imu_s, 115);
  ASSERT_GE(s.suggestions.size(), 2U);
  EXPECT_GE(s.reached, 2);
  EXPECT_LE(s.reached, endedSuggestions(s));
  EXPECT_GE(endedSuggestions(s), static_cast<int>(s.suggestions.size()) - 1);
  for (std::size_t i = 1; i < s.suggestions.size(); ++i) {
    EXPECT_GT(s.suggestions[i].t, s.suggestions[i - 1].t);
  }
  EXPECT_EQ(s.suggestions.back().stage, GuideStage::kCameraImu);
}

// Readings that are noisier than the motion is brisk correlate with the inertial residuals, which
// have the same noise: a mount that gives way to the force was found in nearly all of these.
TEST(OperatedSession, HandsAndNoiseAreNoFault) {
  const SimulatedRig rig = simulatedRig("d435i");
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    OperatedOptions o = options(90);
    o.simulation.seed = seed;
    const OperatedSession s = recordFreely(rig, o);
    CameraImuOptions batch;
    batch.cauchy_px = 0;
    batch.pixel_sigma = o.simulation.corner_sigma_px;
    const auto found = calibrateCameraImu(s.session, rig.calibration.cameras, batch);
    ASSERT_TRUE(found && found->faults) << seed;
    for (const FaultTest& cause : found->faults->causes) {
      ADD_FAILURE() << toString(cause.fault) << ", " << cause.significance << " sigma, " << seed;
    }
  }
}

// Neither reached nor missed; whoever counts both alike leaves it out.
TEST(OperatedSession, WhatIsOpenAtTheEndHasNotEnded) {
  OperatedSession s;
  for (int id = 0; id < 2; ++id) {
    s.suggestions.emplace_back().id = id;
    Decision& opened = s.decisions.emplace_back();
    opened.event = SuggestionEvent::kOpened;
    opened.suggestion = id;
  }
  EXPECT_EQ(endedSuggestions(s), 0);
  s.decisions.emplace_back().event = SuggestionEvent::kExpired;
  s.decisions.back().suggestion = 1;
  EXPECT_EQ(endedSuggestions(s), 1);
  EXPECT_EQ(endOf(s, 0), nullptr);
  ASSERT_NE(endOf(s, 1), nullptr);
  EXPECT_EQ(endOf(s, 1)->event, SuggestionEvent::kExpired);
}

// The guide asks for the next trajectory after five seconds, when a slow person is not done yet.
TEST(OperatedSession, FollowsWhatWasBegunToItsEnd) {
  OperatedOptions o = options(120);
  o.skill.reaction_s = 1.5;
  const OperatedSession s = recordGuided(simulatedRig("d435i"), o);
  EXPECT_TRUE(s.finished);
  EXPECT_LT(s.camera_imu_s, 60);
}

// By predicted error the misfit of a bent board that the guide takes for flat has to be made up for
// by views.
TEST(OperatedSession, AGuideThatKnowsABentBoardEnds) {
  OperatedOptions o = options(90);
  o.simulation.target.shape.terms[8] = 2e-3;  // z_xx, RMS
  ASSERT_STREQ(kTargetTermNames[8], "z_xx");
  const SimulatedRig rig = simulatedRig("d435i");
  o.guide.views.criterion = ViewCriterion::kPredictedError;
  double known_s = 0, flat_s = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {  // persons differ by more
    o.simulation.seed = o.operator_seed = seed;
    OperatedOptions knowing = o;
    knowing.guide_shape = o.simulation.target.shape;
    const OperatedSession known = recordGuided(rig, knowing);
    EXPECT_TRUE(known.finished);
    known_s += known.camera_s;
    flat_s += recordGuided(rig, o).camera_s;
  }
  EXPECT_GT(flat_s, 1.5 * known_s);
}

// Calibrated as a recording is, the truth is found within the noise: sensors and motion agree.
TEST(OperatedSession, GivesTheRigsCalibrationBack) {
  const SimulatedRig rig = simulatedRig("d435i");
  const OperatedSession s = recordFreely(rig, options(20));
  EXPECT_TRUE(s.finished);
  const auto cameras = calibrateCameras(s.session);
  ASSERT_TRUE(cameras);
  const auto& truth = rig.calibration.cameras.front().intrinsics.projection;
  EXPECT_NEAR(cameras->cameras.front().intrinsics.projection[0], truth[0], 1.0);
  const auto imu = calibrateCameraImu(s.session, cameras->cameras);
  ASSERT_TRUE(imu);
  const double offset = rig.calibration.imu->timeOffset();
  EXPECT_LT(*imu->imu.time_offset_std_s, 1e-3);
  EXPECT_NEAR(imu->imu.timeOffset(), offset, 4 * *imu->imu.time_offset_std_s);
  EXPECT_LT(rotationAngle(imu->imu.T_SC0.R.transpose() * rig.calibration.imu->T_SC0.R), 5e-3);
}

TEST(OperatedSession, EndsWithThePersonsPatience) {
  const SimulatedRig rig = simulatedRig("d435i");
  OperatedOptions o = options(60);
  o.skill.patience_s = 6;
  for (const OperatedSession& s : {recordFreely(rig, o), recordGuided(rig, o)}) {
    EXPECT_FALSE(s.finished);
    EXPECT_NEAR(s.camera_s + s.camera_imu_s, 6, 0.2);
    const auto& views = s.session.cameras.front().views;
    EXPECT_NEAR(secondsBetween(views.front().t, views.back().t), 6, 0.2);
    EXPECT_GT(s.session.imu->samples.back().t, views.back().t);
  }
}

TEST(OperatedSession, IsTheSameForTheSameSeeds) {
  const SimulatedRig rig = simulatedRig("d435i");
  const OperatedSession a = recordGuided(rig, options(8)), b = recordGuided(rig, options(8));
  ASSERT_EQ(a.session.imu->samples.size(), b.session.imu->samples.size());
  EXPECT_EQ(a.session.imu->samples.back().accel, b.session.imu->samples.back().accel);
  EXPECT_EQ(a.suggestions.size(), b.suggestions.size());
  OperatedOptions other = options(8);
  other.operator_seed = 2;
  const OperatedSession c = recordGuided(rig, other);
  EXPECT_NE(a.session.imu->samples.back().accel, c.session.imu->samples.back().accel);
}

// A rig at rest in free fall frame: without noise the accelerometer reads the reaction to gravity
// and the motion's acceleration, in its own frame.
TEST(RigSensors, MeasureTheSpline) {
  const SimulatedRig rig = simulatedRig("d435i");
  SimulationOptions o;
  o.duration_s = 2;
  o.imu_noise = false;
  o.initial_gyro_bias = {0.01, 0, 0};
  o.initial_accel_bias = {0, 0.02, 0};
  SplineMotion motion(0.1);
  const Eigen::Vector3d w(0.2, -0.3, 0.4);
  for (int k = 0; k < 40; ++k) {
    motion.add({Eigen::Matrix3d(expSO3(w * (0.1 * k))), Eigen::Vector3d(0.2, 0.3, 1 + 0.01 * k)});
  }
  RigSensors sensors(rig, o);
  const auto samples = sensors.samplesUntil(motion, o.start_ns + toNanoseconds(1.0));
  const Eigen::Matrix3d R_SC = rig.calibration.imu->T_SC0.R;
  const Eigen::Vector3d gyro = samples.back().gyro - o.initial_gyro_bias;
  // Turns w about the axes of F, constant: in the sensor's frame R^T w.
  const Eigen::Matrix3d R_FC = motion.at(1.0).T_FB.R;
  EXPECT_LT((gyro - R_SC * (R_FC.transpose() * w)).norm(), 1e-6);
  const double g = rig.calibration.imu->gravity_m_s2;
  EXPECT_NEAR((samples.back().accel - o.initial_accel_bias).norm(), g, 0.05);
  EXPECT_TRUE(sensors.samplesUntil(motion, o.start_ns + toNanoseconds(1.0)).empty()) << "taken";
  SimulationOptions rates = o, faults = o;
  rates.imu_rate_hz = 100;
  EXPECT_THROW(RigSensors(rig, rates), InputError) << "its rates are the rig's";
  faults.faults = {{.kind = FaultKind::kGyroDelay, .value = 0.005}};
  EXPECT_THROW(RigSensors(rig, faults), InputError) << "of a sensor at rest they would be others";
}

// Across by the bow, half as much the other way along, and a little stretched.
TEST(BentBoard, HasItsBendInMillimetresRms) {
  EXPECT_TRUE(bentBoard(0).isFlat());
  const TargetShape shape = bentBoard(2);
  const AprilGrid flat;
  AprilGrid bent;
  bent.shape = shape;
  const auto points = cornerPoints(bent);
  double heights = 0, middle_up = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    heights += points[i].z() * points[i].z() / static_cast<double>(points.size());
    const Eigen::Vector2d p = flat.corner(static_cast<int>(i));
    if (std::abs(p.x() - 0.5 * flat.width()) < 0.1 * flat.width()) middle_up += points[i].z();
  }
  // The two bows are nearly orthogonal: 2 mm and 1 mm.
  EXPECT_NEAR(1e3 * std::sqrt(heights), std::sqrt(5), 0.3);
  EXPECT_LT(middle_up, 0) << "a bow along x: the sides are up";
  EXPECT_NEAR(1e3 * shape.rms(), std::sqrt(5), 0.3);
}

TEST(SuggestionsCsv, HasItsColumnsInOrder) {
  Suggestion s;
  s.t = 1'400'000'000'000'000'000;
  s.stage = GuideStage::kCameraImu;
  s.id = 7;
  s.camera = 1;
  s.T_FC0 = {expSO3({0, 0, std::numbers::pi / 2}), {1, 2, 3}};
  const std::string csv = suggestionsCsv({s});
  const std::size_t row = csv.find('\n') + 1;
  EXPECT_EQ(csv.substr(0, row), "#t_ns,stage,id,tx [m],ty [m],tz [m],qx,qy,qz,qw,camera\n");
  // A quarter turn about z: the root of a half in qz and qw.
  EXPECT_EQ(csv.substr(row), "1400000000000000000," + toString(GuideStage::kCameraImu) +
                                 ",7,1,2,3,0,0,0.707106781187,0.707106781187,1\n");
}

TEST(OperatedOptions, NameWhatIsOutOfRange) {
  OperatedOptions o;
  o.camera_share = 1.1;
  EXPECT_THROW(recordFreely(simulatedRig("d435i"), o), InputError);
  o = {};
  o.arrival_s = -0.1;
  EXPECT_THROW(recordGuided(simulatedRig("d435i"), o), InputError);
}

}  // namespace
}  // namespace plumbline
