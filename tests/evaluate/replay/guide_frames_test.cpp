// SPDX-License-Identifier: BSD-3-Clause
// A recording in the order in which it would have arrived.
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/replay/frames.h"

namespace plumbline {
namespace {

SimulatedSession simulated() {
  SimulationOptions options;
  options.duration_s = 2;
  return simulateSession(simulatedRig("euroc"), options);
}

TEST(GuideFrames, EverySampleArrivesOnceAndNotBeforeItsTime) {
  const Session session = simulated().session;
  const auto frames = guideFrames(session);
  ASSERT_GT(frames.size(), 30u);
  std::vector<TimeNs> arrived;
  for (const GuideFrame& frame : frames) {
    for (const ImuSample& sample : frame.imu) {
      arrived.push_back(sample.t);
      EXPECT_LE(sample.t, frame.t + 50'000'000);
    }
    EXPECT_GE(arrived.back(), frame.t) << "an image is there 50 ms after its stamp";
  }
  std::vector<TimeNs> recorded;
  for (const ImuSample& sample : session.imu->samples) {
    if (sample.t <= frames.back().t + 50'000'000) recorded.push_back(sample.t);
  }
  EXPECT_EQ(arrived, recorded);
}

TEST(GuideFrames, RefuseOptionsOutOfRange) {
  const Session session = simulated().session;
  EXPECT_THROW(guideFrames(session, {.tolerance = -1}), InputError);
  EXPECT_THROW(guideFrames(session, {.arrival_s = -0.01}), InputError);
  EXPECT_THROW(guideFrames(session, {.arrival_s = std::numeric_limits<double>::infinity()}),
               InputError);
}

TEST(GuideFrames, AFrameWithoutTheTargetIsAFrame) {
  Session session = simulated().session;
  const std::size_t before = guideFrames(session).size();
  for (CameraStream& camera : session.cameras) camera.views[5].corners.clear();
  const auto frames = guideFrames(session);
  ASSERT_EQ(frames.size(), before);
  EXPECT_TRUE(frames[5].corners[0].empty() && frames[5].corners[1].empty());
  EXPECT_EQ(frames[5].index, 5);
}

TEST(GuideFrames, ASessionOfSomeFramesHasTheirViewsAndNoOthers) {
  const Session session = simulated().session;
  const auto frames = guideFrames(session);
  const std::vector<Decision> none;
  const Session some = ReplayRun{session, frames, none, {}, {}, {}}.sessionOfFrames({3, 8});
  ASSERT_EQ(some.cameras.size(), 2u);
  ASSERT_EQ(some.cameras[1].views.size(), 2u);
  EXPECT_EQ(some.cameras[1].views[1].t, frames[8].t);
  EXPECT_EQ(some.cameras[1].views[1].corners.size(), frames[8].corners[1].size());
  EXPECT_EQ(some.imu->samples.size(), session.imu->samples.size());
}

TEST(GuideRig, TakesTheSessionsWordsOrTheOptions) {
  const Session session = simulated().session;
  EXPECT_EQ(guideRig(session).cameras[0].model.distortion, DistortionModel::kRadtan);
  const CameraModelPair wide{ProjectionModel::kPinhole, DistortionModel::kEquidistant};
  EXPECT_EQ(guideRig(session, {wide, wide}).cameras[1].model.distortion,
            DistortionModel::kEquidistant);
  EXPECT_TRUE(guideRig(session).imu.has_value());
}

}  // namespace
}  // namespace plumbline
