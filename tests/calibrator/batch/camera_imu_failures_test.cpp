// SPDX-License-Identifier: BSD-3-Clause
// Recordings that cannot or must not be calibrated: each ends in one failure that names the cause.
#include <functional>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::matchedOptions;
using testing::noisyRecording;
using testing::simulate;

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
  EXPECT_EQ(failureOf(s).reason, FailureReason::kNoOverlap);
}

TEST(CameraImuFailures, AccelerometerInG) {
  const Failure f = withSamples([](ImuSample& s) { s.accel /= 9.80665; });
  EXPECT_EQ(f.reason, FailureReason::kImplausible);
  EXPECT_THAT(f.message, HasSubstr("in g"));
  EXPECT_THAT(f.cure, HasSubstr("9.80665"));
}

TEST(CameraImuFailures, GyroscopeInDegrees) {
  const Failure f = withSamples([](ImuSample& s) { s.gyro *= 57.29577951308232; });
  EXPECT_EQ(f.reason, FailureReason::kImplausible);
  EXPECT_THAT(f.message, HasSubstr("degrees per second"));
}

TEST(CameraImuFailures, SwappedColumns) {
  const Failure f = withSamples([](ImuSample& s) { std::swap(s.gyro, s.accel); });
  EXPECT_EQ(f.reason, FailureReason::kImplausible);
  EXPECT_THAT(f.message, HasSubstr("swapped"));
}

TEST(CameraImuFailures, MirroredGyroscopeAxis) {
  const Failure f = withSamples([](ImuSample& s) { s.gyro.z() *= -1; });
  EXPECT_EQ(f.reason, FailureReason::kImplausible);
  EXPECT_THAT(f.message, HasSubstr("permuted or mirrored"));
}

TEST(CameraImuFailures, PermutedGyroscopeAxes) {
  const Failure f = withSamples([](ImuSample& s) { std::swap(s.gyro.x(), s.gyro.y()); });
  EXPECT_EQ(f.reason, FailureReason::kImplausible);
  EXPECT_THAT(f.message, HasSubstr("permuted or mirrored"));
}

TEST(CameraImuFailures, PermutedAccelerometerAxes) {
  const Failure f = withSamples([](ImuSample& s) { std::swap(s.accel.x(), s.accel.y()); });
  EXPECT_EQ(f.reason, FailureReason::kImplausible);
  EXPECT_THAT(f.message, ::testing::AnyOf(HasSubstr("axes do not fit"), HasSubstr("gravity")));
}

TEST(CameraImuFailures, WrongTargetSize) {
  SimulatedSession s = simulate(noisyRecording(2, 8));
  s.session.target.tag_size *= 2;
  const Failure f = failureOf(s);
  EXPECT_EQ(f.reason, FailureReason::kImplausible);
  EXPECT_THAT(f.message, AllOf(HasSubstr("tagSize"), HasSubstr("times too large")));
}

TEST(CameraImuFailures, OtherClock) {
  SimulatedSession s = simulate(noisyRecording(3));
  for (ImuSample& sample : s.session.imu->samples) sample.t += 3'600'000'000'000;
  EXPECT_EQ(failureOf(s).reason, FailureReason::kNoOverlap);
}

TEST(CameraImuFailures, ImuOfAnotherRecording) {
  SimulatedSession s = simulate(noisyRecording(4, 8));
  SimulationOptions other = noisyRecording(5, 8);
  other.trajectory.seed = 77;
  s.session.imu = simulate(other).session.imu;
  const Failure f = failureOf(s);
  EXPECT_EQ(f.reason, FailureReason::kNoOverlap);
  EXPECT_THAT(f.message, HasSubstr("do not correlate"));
}

TEST(CameraImuFailures, FewViews) {
  SimulatedSession s = simulate(noisyRecording(6));
  for (CameraStream& camera : s.session.cameras) {
    for (std::size_t i = 5; i < camera.views.size(); ++i) camera.views[i].corners.clear();
  }
  EXPECT_EQ(failureOf(s).reason, FailureReason::kTooFewViews);
}

SimulatedSession moving(MotionKind kind, const Eigen::Vector3d& axis_S) {
  SimulationOptions options = noisyRecording(7, 8);
  options.trajectory.kind = kind;
  options.trajectory.axis_S = axis_S;
  return simulate(options);
}

TEST(CameraImuFailures, AtRest) {
  const Failure f = failureOf(moving(MotionKind::kStatic, Eigen::Vector3d::UnitY()));
  EXPECT_EQ(f.reason, FailureReason::kNotObservable);
  EXPECT_THAT(f.message, HasSubstr("time offset"));
}

TEST(CameraImuFailures, RotationAboutOneAxisNamesWhatStaysUnknown) {
  const std::pair<Eigen::Vector3d, const char*> axes[] = {
      {Eigen::Vector3d::UnitX(),
       "translation along x of T_SC0 is not observable: no rotation about y or z"},
      {Eigen::Vector3d::UnitY(),
       "translation along y of T_SC0 is not observable: no rotation about x or z"},
      {Eigen::Vector3d::UnitZ(),
       "translation along z of T_SC0 is not observable: no rotation about x or y"}};
  for (const auto& [axis, message] : axes) {
    for (const MotionKind kind :
         {MotionKind::kSingleAxisRotation, MotionKind::kPlanar, MotionKind::kPureRotation}) {
      const Failure f = failureOf(moving(kind, axis));
      EXPECT_EQ(f.reason, FailureReason::kNotObservable);
      EXPECT_THAT(f.message, HasSubstr(message));
    }
  }
}

}  // namespace
}  // namespace plumbline
