// SPDX-License-Identifier: BSD-3-Clause
// False corners, swapped ids, repeated views and spikes leave the calibration where the clean
// recording has it, and are found. Faults have random numbers of their own, so that both
// recordings share all other noise. Not proven here: more of them than is said.
#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/simulate/faults/fault.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

constexpr double kRobustDuration = 20;

Fault faultOf(FaultKind kind, double value, double extent) {
  Fault fault;
  fault.kind = kind;
  fault.value = value;
  fault.extent = extent;
  return fault;
}

struct Recording {
  const char* rig = "euroc";
  std::uint64_t seed = 1;
  bool mono = false;
};

CameraImuStageResult calibrated(const Recording& recording, const std::vector<Fault>& faults) {
  SimulationOptions simulation = test::noisyRecording(recording.seed, kRobustDuration);
  simulation.trajectory.seed = recording.seed;
  simulation.faults = faults;
  SimulatedSession simulated = test::simulate(simulation, recording.rig);
  if (recording.mono) {
    simulated.session.cameras.resize(1);
    simulated.truth.cameras.resize(1);
  }
  CameraImuOptions options;
  options.pixel_sigma = 0.2;
  options.gravity_m_s2 = simulated.gravity_F.norm();
  options.diagnose_faults = false;
  options.noise_check = false;
  const auto result = calibrateCameraImu(simulated.session, simulated.truth.cameras, options);
  EXPECT_TRUE(result) << (result ? "" : toString(result.failure()));
  return result ? *result : CameraImuStageResult();
}

/// The largest distance between the two in deviations of the clean one.
double distance(const CameraImuStageResult& clean, const CameraImuStageResult& faulty) {
  Eigen::Matrix<double, 7, 1> d, std;
  d << boxminus(faulty.imu.T_SC0, clean.imu.T_SC0),
      faulty.imu.timeOffset() - clean.imu.timeOffset();
  std << *clean.imu.T_SC0_std, *clean.imu.time_offset_std_s;
  return d.cwiseAbs().cwiseQuotient(std).maxCoeff();
}

class RobustStart : public ::testing::TestWithParam<Recording> {};

TEST_P(RobustStart, TenPercentFalseCorners) {
  const CameraImuStageResult clean = calibrated(GetParam(), {});
  const auto faulty = calibrated(GetParam(), {faultOf(FaultKind::kFalseCorners, 0.1, 10)});
  EXPECT_LT(distance(clean, faulty), 1);
  EXPECT_EQ(clean.screening.false_corners, 0U);
  const auto offered = static_cast<double>(faulty.summary.corners_offered);
  EXPECT_NEAR(static_cast<double>(faulty.screening.false_corners) / offered, 0.1, 0.01);
}

TEST_P(RobustStart, OnePercentSwappedIds) {
  const CameraImuStageResult clean = calibrated(GetParam(), {});
  const auto faulty = calibrated(GetParam(), {faultOf(FaultKind::kSwappedIds, 0.01, 0)});
  EXPECT_LT(distance(clean, faulty), 1);
  EXPECT_TRUE(clean.screening.misplaced_tags.empty());
  ASSERT_FALSE(faulty.screening.misplaced_tags.empty());
  for (const MisplacedTag& tag : faulty.screening.misplaced_tags) EXPECT_NE(tag.place, tag.tag);
}

TEST_P(RobustStart, TenSpikesAMinute) {
  const CameraImuStageResult clean = calibrated(GetParam(), {});
  EXPECT_TRUE(clean.screening.spikes.empty());
  for (const double size : {5.0, 100.0}) {
    const auto gyro = calibrated(GetParam(), {faultOf(FaultKind::kSpike, 10 / 60.0, size)});
    EXPECT_LT(distance(clean, gyro), 1) << size;
    EXPECT_FALSE(gyro.screening.spikes.empty());
    const auto accel =
        calibrated(GetParam(), {faultOf(FaultKind::kAccelSpike, 10 / 60.0, 5 * size)});
    EXPECT_LT(distance(clean, accel), 1) << size;
    EXPECT_FALSE(accel.screening.spikes.empty());
  }
}

TEST_P(RobustStart, RepeatedViews) {
  const CameraImuStageResult clean = calibrated(GetParam(), {});
  EXPECT_TRUE(clean.screening.repeated_views.empty());
  const auto faulty = calibrated(GetParam(), {faultOf(FaultKind::kFrozen, 0.3, 0)});
  // Views are lost, and their noise with them.
  EXPECT_LT(distance(clean, faulty), 1);
  EXPECT_FALSE(faulty.screening.repeated_views.empty());
}

INSTANTIATE_TEST_SUITE_P(Rigs, RobustStart,
                         ::testing::Values(Recording{"euroc", 1, false},
                                           Recording{"euroc", 2, true},
                                           Recording{"tumvi", 3, false}));

}  // namespace
}  // namespace plumbline
