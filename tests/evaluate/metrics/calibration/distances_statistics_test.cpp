// SPDX-License-Identifier: BSD-3-Clause
// What the distance of a calibration from one of more frames says of its error against the truth.
#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/metrics/calibration/distances.h"

namespace plumbline {
namespace {

SimulatedSession recording(std::uint64_t seed) {
  SimulationOptions options;
  options.seed = options.trajectory.seed = seed;
  options.duration_s = 10;
  options.camera_rate_hz = 10;
  return simulateSession(simulatedRig("euroc"), options);
}

/// Of expected squared errors and those that came, over recordings.
struct Squares {
  double expected = 0, came = 0;

  void add(const Distance& expected_from, const Distance& truth_from) {
    expected += expected_from.expectedError() * expected_from.expectedError();
    came += truth_from.value * truth_from.value;
  }
  double ratio() const { return came / expected; }
};

TEST(CameraDistances, WithTheDeviationTheyAreTheErrorToBeExpectedOfAPart) {
  Squares projection, translation, rotation;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const SimulatedSession made = recording(seed);
    Session part = made.session;
    for (CameraStream& camera : part.cameras) {
      std::vector<ImageView> every_fourth;
      for (std::size_t i = 0; i < camera.views.size(); i += 4) {
        every_fourth.push_back(camera.views[i]);
      }
      camera.views = every_fourth;
    }
    const auto all = calibrateCameras(made.session), some = calibrateCameras(part);
    ASSERT_TRUE(all && some);
    const auto from_all = cameraDistances(some->cameras, *all);
    const auto from_truth = cameraDistances(made.truth.cameras, *some);
    for (std::size_t c = 0; c < from_all.size(); ++c) {
      projection.add(from_all[c].projection_px, from_truth[c].projection_px);
    }
    translation.add(from_all[1].translation_m, from_truth[1].translation_m);
    rotation.add(from_all[1].rotation_rad, from_truth[1].rotation_rad);
    EXPECT_EQ(from_all[0].translation_m.value, 0);
  }
  for (const Squares* s : {&projection, &translation, &rotation}) {
    EXPECT_GT(s->ratio(), 0.6);
    EXPECT_LT(s->ratio(), 1.6);
  }
}

TEST(ImuDistances, WithTheDeviationTheyAreTheErrorToBeExpectedOfAPart) {
  Squares translation, rotation, offset;
  CameraImuOptions options;
  options.noise_check = false;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const SimulatedSession made = recording(seed);
    Session part = made.session;
    for (CameraStream& camera : part.cameras) camera.views.resize(camera.views.size() / 2);
    const auto& cameras = made.truth.cameras;
    const auto all = calibrateCameraImu(made.session, cameras, options);
    const auto some = calibrateCameraImu(part, cameras, options);
    ASSERT_TRUE(all && some);
    const ImuDistance from_all = imuDistance(some->imu, *all);
    const ImuDistance from_truth = imuDistance(*made.truth.imu, *some);
    translation.add(from_all.translation_m, from_truth.translation_m);
    rotation.add(from_all.rotation_rad, from_truth.rotation_rad);
    offset.add(from_all.offset_s, from_truth.offset_s);
  }
  for (const Squares* s : {&translation, &rotation, &offset}) {
    EXPECT_GT(s->ratio(), 0.5);
    EXPECT_LT(s->ratio(), 2);
  }
}

}  // namespace
}  // namespace plumbline
