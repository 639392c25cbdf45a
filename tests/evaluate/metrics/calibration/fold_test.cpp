// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/fold.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "calibrator/base/frames.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

Session recordedSession() {
  SimulationOptions options;
  options.duration_s = 6;
  options.camera_rate_hz = 8;
  return simulateSession(simulatedRig("euroc"), options).session;
}

std::set<TimeNs> stampsOf(const CameraStream& camera) {
  std::set<TimeNs> stamps;
  for (const ImageView& view : camera.views) stamps.insert(view.t);
  return stamps;
}

TEST(Folds, PartEveryFrameOnceIntoRunsOfTime) {
  const Session session = recordedSession();
  const auto frames = static_cast<int>(pairFrames(session.cameras).size());
  ASSERT_GT(frames, 30);
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    std::set<TimeNs> seen;
    for (int k = 0; k < 5; ++k) {
      const Fold fold = foldOf(session, {}, {k, 5});
      const auto held_out = stampsOf(fold.held_out.cameras[c]);
      const auto training = stampsOf(fold.training.cameras[c]);
      EXPECT_LE(std::abs(static_cast<double>(held_out.size()) - frames / 5.0), 1);
      EXPECT_EQ(held_out.size() + training.size(), static_cast<std::size_t>(frames));
      // One run: no training frame lies between two that are held out.
      EXPECT_TRUE(std::none_of(training.begin(), training.end(), [&](TimeNs t) {
        return t >= *held_out.begin() && t <= *held_out.rbegin();
      }));
      for (const TimeNs t : held_out) EXPECT_TRUE(seen.insert(t).second) << "held out twice";
    }
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(frames));
  }
}

TEST(Folds, KeepWhatIsNotOfViews) {
  const Session session = recordedSession();
  const Fold fold = foldOf(session, {}, {1, 3});
  for (const Session* part : {&fold.training, &fold.held_out}) {
    EXPECT_EQ(part->name, session.name);
    EXPECT_EQ(part->target.rows, session.target.rows);
    EXPECT_EQ(part->cameras[1].name, session.cameras[1].name);
    EXPECT_EQ(part->cameras[1].resolution, session.cameras[1].resolution);
  }
}

TEST(Folds, NoSampleBetweenHeldOutFramesIsForTraining) {
  const Session session = recordedSession();
  for (const double offset_s : {0.0, 0.25}) {
    const Fold fold = foldOf(session, {}, {1, 3, offset_s});
    const auto held_out = stampsOf(fold.held_out.cameras[0]);
    const TimeNs from = *held_out.begin() + toNanoseconds(offset_s);
    const TimeNs to = *held_out.rbegin() + toNanoseconds(offset_s);
    std::size_t inside = 0;
    for (const ImuSample& s : session.imu->samples) inside += s.t > from && s.t < to ? 1 : 0;
    ASSERT_GT(inside, 100U);
    EXPECT_EQ(fold.training.imu->samples.size(), session.imu->samples.size() - inside);
    for (const ImuSample& s : fold.training.imu->samples) EXPECT_FALSE(s.t > from && s.t < to);
    EXPECT_EQ(fold.held_out.imu->samples.size(), session.imu->samples.size());
  }
}

TEST(Folds, KeepAFramesViewsTogetherWhereStampsAreShifted) {
  Session session = recordedSession();
  for (ImageView& view : session.cameras[1].views) view.t += 30'000'000;
  const Fold fold = foldOf(session, {}, {0, 4});
  ASSERT_EQ(fold.held_out.cameras[0].views.size(), fold.held_out.cameras[1].views.size());
  for (std::size_t i = 0; i < fold.held_out.cameras[0].views.size(); ++i) {
    EXPECT_EQ(fold.held_out.cameras[1].views[i].t - fold.held_out.cameras[0].views[i].t,
              30'000'000);
  }
}

}  // namespace
}  // namespace plumbline
