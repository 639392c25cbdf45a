// SPDX-License-Identifier: BSD-3-Clause
// What is told of cameras that explain their corners alone, but not together.
#include "evaluate/calibration/failure_causes.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(CauseOfCameraFailure, ACameraThatFitsAloneIsNotBlamedForTheOther) {
  Session session = recorded();
  int i = 0;
  for (ImageView& view : session.cameras[0].views) {
    for (Corner& corner : view.corners) corner.uv = {7.0 * (++i % 97), 5.0 * (i % 89)};
  }
  const Failure of_cam1{FailureCode::kDistortionFree, {{"camera", "cam1"}, {"reach", 0.4}}};
  const Failure told = causeOfCameraFailure(of_cam1, {}, session);
  EXPECT_EQ(std::get<std::string>(told.values.at("camera").content()), "cam0");
}

}  // namespace
}  // namespace plumbline
