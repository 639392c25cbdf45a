// SPDX-License-Identifier: BSD-3-Clause
// What is told of cameras that explain their corners alone, but not together.
#include "evaluate/calibration/failure_causes.h"

#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/time.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/calibration/cameras_apart.h"
#include "evaluate/metrics/failure_text.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

Session recorded() {
  SimulationOptions options;
  options.duration_s = 8;
  options.camera_rate_hz = 10;
  return simulateSession(simulatedRig("euroc"), options).session;
}

/// Each view of cam1 has the corners of one that is `views` later.
Session late(int views) {
  Session session = recorded();
  std::vector<ImageView>& all = session.cameras[1].views;
  const auto by = static_cast<std::size_t>(views);
  for (std::size_t v = 0; v + by < all.size(); ++v) all[v].corners = all[v + by].corners;
  all.resize(all.size() - by);
  return session;
}

TEST(CamerasApart, AreThoseWhoseRotationVaries) {
  const auto turnOf = [](const Session& session) {
    const auto alone = calibratedAlone(session, {});
    EXPECT_TRUE(alone[0] && alone[1]);
    return camerasApart(session, alone, {});
  };
  EXPECT_FALSE(turnOf(recorded()));
  const auto apart = turnOf(late(1));
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->first, "cam0");
  EXPECT_EQ(apart->second, "cam1");
  EXPECT_GT(apart->frames, 50);
  EXPECT_GT(apart->turn_deg, 2);
  EXPECT_GT(turnOf(late(10))->turn_deg, apart->turn_deg);
}

TEST(CauseOfCameraFailure, CamerasThatFitAloneAreNamedWithWhatPartsThem) {
  const Session session = late(1);
  const Failure together{FailureCode::kCamerasNotConverged, {{"iterations", 100}}};
  CalibrateRequest request;
  EXPECT_THAT(textOf(causeOfCameraFailure(together, request, session)).message,
              HasSubstr("cam0 and cam1 do not go together: alone each camera explains"));
  // Of few frames nothing was tested.
  Failure few = together;
  few.values.insert({{"selected_frames", 5}, {"selected_from", 80}});
  EXPECT_THAT(textOf(causeOfCameraFailure(few, request, session)).message,
              HasSubstr("did not converge"));
  const Failure of_views{FailureCode::kTooFewViews, {{"camera", "cam0"}}};
  EXPECT_EQ(causeOfCameraFailure(of_views, request, session).values.size(), 1U);
  EXPECT_EQ(causeOfCameraFailure(together, request, recorded()).values.count("turn_deg"), 0U);
}

/// Corners of the camera that no lens explains.
void spoil(Session& session, std::size_t camera) {
  int i = 0;
  for (ImageView& view : session.cameras[camera].views) {
    for (Corner& corner : view.corners) corner.uv = {7.0 * (++i % 97), 5.0 * (i % 89)};
  }
}

TEST(CauseOfCameraFailure, ACameraThatFitsAloneIsNotBlamedForTheOther) {
  Session session = recorded();
  spoil(session, 0);
  const Failure of_cam1{FailureCode::kDistortionFree, {{"camera", "cam1"}, {"reach", 0.4}}};
  const Failure told = causeOfCameraFailure(of_cam1, {}, session);
  EXPECT_EQ(std::get<std::string>(told.values.at("camera").content()), "cam0");
}

TEST(CauseOfCameraFailure, EveryCameraThatFailsAloneIsTold) {
  Session session = recorded();
  spoil(session, 1);
  const Failure together{FailureCode::kCamerasNotConverged, {{"iterations", 100}}};
  EXPECT_THAT(textOf(causeOfCameraFailure(together, {}, session)).message,
              testing::AllOf(HasSubstr("in 100 iterations; also "), HasSubstr("cam1"),
                             testing::Not(HasSubstr("cam0"))));
  spoil(session, 0);
  const Failure of_cam1{
      FailureCode::kDistortionFree,
      {{"camera", "cam1"}, {"direction", std::vector<std::string>{"cam1.k1"}}, {"reach", 0.4}}};
  EXPECT_THAT(textOf(causeOfCameraFailure(of_cam1, {}, session)).message,
              testing::AllOf(testing::StartsWith("not observable: the distortion of cam1"),
                             HasSubstr("; also "), HasSubstr("cam0")));
}

// The stamps' step is the further cause of cam1 alone: what explains most is the gyroscope's jump,
// which both cameras show.
TEST(CauseOfImuFailure, StampsThatContradictTheGyroscopeNeedNotBeTheFirstCause) {
  SimulationOptions options;
  options.duration_s = 16;
  options.camera_rate_hz = 10;
  options.faults = {{.kind = FaultKind::kBiasJump, .value = 0.05, .at_s = 6}};
  SimulatedSession simulated = simulateSession(simulatedRig("euroc"), options);
  LoadedSession loaded;
  loaded.session = simulated.session;
  for (ImageView& view : loaded.session.cameras[1].views) {
    if (view.t > loaded.session.cameras[1].views.front().t + toNanoseconds(11)) {
      view.t += toNanoseconds(2e-3);
    }
  }
  const std::vector<CameraCalibration>& cameras = simulated.truth.cameras;
  Session alone = loaded.session;
  alone.cameras.erase(alone.cameras.begin());
  std::vector<CameraCalibration> cam1 = {cameras[1]};
  cam1.front().T_C0Ci = {};
  const auto stage = calibrateCameraImu(alone, cam1, {});
  ASSERT_TRUE(stage && stage->faults && stage->faults->causes.size() > 1);
  ASSERT_EQ(stage->faults->causes[0].fault, UnmodelledFault::kGyroBiasJump);
  ASSERT_EQ(stage->faults->causes[1].fault, UnmodelledFault::kClockStep);
  const Failure uncorrelated{FailureCode::kRatesDoNotCorrelate,
                             {{"correlation", 0.5}, {"needed", 0.8}}};
  const Failure told = causeOfImuFailure(uncorrelated, {}, loaded, cameras, {});
  ASSERT_EQ(told.values.count("cameras"), 1U);
  EXPECT_EQ(std::get<std::vector<std::string>>(told.values.at("cameras").content()),
            std::vector<std::string>{"cam1"});
}

}  // namespace
}  // namespace plumbline
