// SPDX-License-Identifier: BSD-3-Clause
// Recordings that cannot or must not be calibrated: each ends in one failure that names the cause.
#include <functional>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

using test::matchedOptions;
using test::noisyRecording;
using test::simulate;
using ::testing::AllOf;
using ::testing::HasSubstr;

Failure failureOf(const SimulatedSession& s) {
  const auto r = calibrateCameraImu(s.session, s.truth.cameras, matchedOptions(s, 0.2));
  if (!r) return r.failure();
  ADD_FAILURE() << "calibrated; standard deviations "
                << r->summary.covariance.standardDeviations().transpose();
  return {};
}

/// The failure after something was done to every IMU sample of a good recording.
Failure withSamples(const std::function<void(ImuSample&)>& change) {
  SimulatedSession s = simulate(noisyRecording(1, 6));
  for (ImuSample& sample : s.session.imu->samples) change(sample);
  return failureOf(s);
}

TEST(CameraImuFailures, NoImu) {
  SimulatedSession s = simulate(noisyRecording(1));
  s.session.imu.reset();
  EXPECT_EQ(failureOf(s).code, FailureCode::kNoImu);
}

TEST(CameraImuFailures, AccelerometerInG) {
  const Failure f = withSamples([](ImuSample& s) { s.accel /= 9.80665; });
  EXPECT_EQ(f.code, FailureCode::kAccelerometerInG);
  EXPECT_EQ(f.reason(), FailureReason::kImplausible);
  EXPECT_EQ(f.input(), FaultyInput::kImuSamples);
  EXPECT_NEAR(f.number("accel"), 1, 0.2);
}

TEST(CameraImuFailures, GyroscopeInDegrees) {
  const Failure f = withSamples([](ImuSample& s) { s.gyro *= 57.29577951308232; });
  EXPECT_EQ(f.code, FailureCode::kGyroscopeInDegrees);
  EXPECT_NEAR(f.number("ratio"), 57.3, 3);
}

TEST(CameraImuFailures, SwappedColumns) {
  const Failure f = withSamples([](ImuSample& s) { std::swap(s.gyro, s.accel); });
  EXPECT_EQ(f.code, FailureCode::kColumnsSwapped);
}

TEST(CameraImuFailures, MirroredGyroscopeAxis) {
  const Failure f = withSamples([](ImuSample& s) { s.gyro.z() *= -1; });
  EXPECT_EQ(f.code, FailureCode::kGyroscopeMirrored);
  EXPECT_GT(f.number("mirrored"), f.number("rotated"));
}

TEST(CameraImuFailures, PermutedGyroscopeAxes) {
  const Failure f = withSamples([](ImuSample& s) { std::swap(s.gyro.x(), s.gyro.y()); });
  EXPECT_EQ(f.code, FailureCode::kGyroscopeMirrored);
  EXPECT_GT(f.number("mirrored"), f.number("rotated"));
}

TEST(CameraImuFailures, PermutedAccelerometerAxes) {
  const Failure f = withSamples([](ImuSample& s) { std::swap(s.accel.x(), s.accel.y()); });
  EXPECT_THAT(f.code,
              ::testing::AnyOf(FailureCode::kAccelerometerAxes, FailureCode::kGravityDisagrees));
}

TEST(CameraImuFailures, AxesAreNamedOnlyWhereOthersFit) {
  const Failure f = withSamples(
      [](ImuSample& s) { s.accel = Eigen::Vector3d(s.accel.y(), s.accel.z(), s.accel.x()); });
  EXPECT_EQ(f.code, FailureCode::kAccelerometerAxes);
  EXPECT_LT(f.number("other_rms"), 0.2 * f.number("rms"));
  // Samples at 200 Hz show this vibration at 1 Hz.
  SimulationOptions recording = noisyRecording(1, 6);
  Fault vibration;
  vibration.kind = FaultKind::kVibration;
  vibration.value = 8;
  vibration.extent = 199;
  recording.faults = {vibration};
  const Failure aliased = failureOf(simulate(recording));
  EXPECT_EQ(aliased.code, FailureCode::kAccelerometerAxes);
  EXPECT_EQ(aliased.values.count("other_rms"), 0U) << aliased;
}

TEST(CameraImuFailures, WrongTargetSize) {
  SimulatedSession s = simulate(noisyRecording(2, 8));
  s.session.target.tag_size *= 2;
  const Failure f = failureOf(s);
  EXPECT_EQ(f.code, FailureCode::kScaleDisagrees);
  EXPECT_EQ(f.input(), FaultyInput::kTarget);
  EXPECT_LT(f.number("scale") + 6 * f.number("scale_std"), 1);  // tags are stated too large
  EXPECT_EQ(f.number("tag_size"), s.session.target.tag_size);
}

TEST(CameraImuFailures, OtherClock) {
  SimulatedSession s = simulate(noisyRecording(3));
  for (ImuSample& sample : s.session.imu->samples) sample.t += 3'600'000'000'000;
  EXPECT_EQ(failureOf(s).code, FailureCode::kImuDoesNotCover);
}

TEST(CameraImuFailures, ImuOfAnotherRecording) {
  SimulatedSession s = simulate(noisyRecording(4, 8));
  SimulationOptions other = noisyRecording(5, 8);
  other.trajectory.seed = 77;
  s.session.imu = simulate(other).session.imu;
  const Failure f = failureOf(s);
  EXPECT_EQ(f.code, FailureCode::kRatesDoNotCorrelate);
  EXPECT_LT(f.number("correlation"), f.number("needed"));
}

// Too short to be tested for faults; without tests the offset of the whole is estimated.
TEST(CameraImuFailures, AClockThatWasSetIsRefusedWhereFaultsAreLookedFor) {
  Fault set;
  set.kind = FaultKind::kClockStep;
  set.value = 0.012;
  set.at_s = 3;
  SimulationOptions recording = noisyRecording(1, 6);
  recording.faults = {set};
  const SimulatedSession s = simulate(recording);
  EXPECT_EQ(failureOf(s).code, FailureCode::kStampsWander);
  CameraImuOptions untested = matchedOptions(s, 0.2);
  untested.diagnose_faults = false;
  const auto r = calibrateCameraImu(s.session, s.truth.cameras, untested);
  ASSERT_TRUE(r.ok()) << r.failure();
  EXPECT_NEAR(r->imu.timeOffset(), s.truth.imu->timeOffset() + 0.006, 0.006);
}

TEST(CameraImuFailures, FewViews) {
  SimulatedSession s = simulate(noisyRecording(6));
  for (CameraStream& camera : s.session.cameras) {
    for (std::size_t i = 5; i < camera.views.size(); ++i) camera.views[i].corners.clear();
  }
  EXPECT_EQ(failureOf(s).reason(), FailureReason::kTooFewViews);
}

SimulatedSession moving(MotionKind kind, const Eigen::Vector3d& axis_S) {
  SimulationOptions options = noisyRecording(7, 8);
  options.trajectory.kind = kind;
  options.trajectory.axis_S = axis_S;
  return simulate(options);
}

TEST(CameraImuFailures, AtRest) {
  const Failure f = failureOf(moving(MotionKind::kStatic, Eigen::Vector3d::UnitY()));
  EXPECT_EQ(f.code, FailureCode::kNoRotation);
  EXPECT_EQ(f.reason(), FailureReason::kNotObservable);
}

TEST(CameraImuFailures, RotationAboutOneAxisNamesWhatStaysUnknown) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    for (const MotionKind kind :
         {MotionKind::kSingleAxisRotation, MotionKind::kPlanar, MotionKind::kPureRotation}) {
      const Failure f = failureOf(moving(kind, axis));
      ASSERT_EQ(f.code, FailureCode::kRotationAboutOneAxis) << f;
      const auto found = std::get<Eigen::Vector3d>(f.values.at("axis").content());
      EXPECT_GT(std::abs(found.dot(axis)), 0.99) << f;
    }
  }
}

}  // namespace
}  // namespace plumbline
