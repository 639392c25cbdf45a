// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/simulate_session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

SimulationOptions shortOptions() {
  SimulationOptions o;
  o.duration_s = 4;
  return o;
}

bool sameViews(const SimulatedSession& a, const SimulatedSession& b) {
  for (std::size_t i = 0; i < a.session.cameras.size(); ++i) {
    const auto& u = a.session.cameras[i].views;
    const auto& v = b.session.cameras[i].views;
    if (u.size() != v.size()) return false;
    for (std::size_t k = 0; k < u.size(); ++k) {
      if (u[k].t != v[k].t || u[k].corners.size() != v[k].corners.size()) return false;
      for (std::size_t c = 0; c < u[k].corners.size(); ++c) {
        if (u[k].corners[c].id != v[k].corners[c].id) return false;
        if (u[k].corners[c].uv != v[k].corners[c].uv) return false;
      }
    }
  }
  return true;
}

bool sameImu(const SimulatedSession& a, const SimulatedSession& b) {
  const auto& u = a.session.imu->samples;
  const auto& v = b.session.imu->samples;
  if (u.size() != v.size()) return false;
  for (std::size_t k = 0; k < u.size(); ++k) {
    if (u[k].t != v[k].t || u[k].gyro != v[k].gyro || u[k].accel != v[k].accel) return false;
  }
  return true;
}

TEST(SimulateSession, SaysWhereNoImuSampleIsLeft) {
  SimulationOptions o = shortOptions();
  o.imu_margin_s = 0;
  o.time_offset_s = 0;
  o.faults = {{.kind = FaultKind::kGap, .value = 10, .at_s = 0}};
  EXPECT_THROW((void)simulateSession(simulatedRig("euroc"), o), InputError);
}

TEST(SimulateSession, SameSeedSameSession) {
  const SimulatedSession a = simulateSession(simulatedRig("euroc"), shortOptions());
  const SimulatedSession b = simulateSession(simulatedRig("euroc"), shortOptions());
  EXPECT_TRUE(sameViews(a, b));
  EXPECT_TRUE(sameImu(a, b));
  SimulationOptions other = shortOptions();
  other.seed = 2;
  const SimulatedSession c = simulateSession(simulatedRig("euroc"), other);
  EXPECT_FALSE(sameViews(a, c));
  EXPECT_FALSE(sameImu(a, c));
  EXPECT_EQ(a.states[10].T_FS.matrix(), c.states[10].T_FS.matrix());  // the motion has its own
}

TEST(SimulateSession, OptionsOfOneSensorLeaveTheOthersNoiseAlone) {
  const SimulationOptions o = shortOptions();
  const SimulatedSession reference = simulateSession(simulatedRig("euroc"), o);
  SimulationOptions quiet_imu = o;
  quiet_imu.imu_noise = false;
  EXPECT_TRUE(sameViews(reference, simulateSession(simulatedRig("euroc"), quiet_imu)));
  SimulationOptions other_corners = o;
  other_corners.corner_sigma_px = 1;
  other_corners.outlier_fraction = 0.1;
  other_corners.dropped_fraction = 0.2;
  EXPECT_TRUE(sameImu(reference, simulateSession(simulatedRig("euroc"), other_corners)));
}

// Dropping frames, or hiding tags, must not change the noise of what remains.
TEST(SimulateSession, RemainingCornersKeepTheirNoise) {
  SimulationOptions o = shortOptions();
  const SimulatedSession all = simulateSession(simulatedRig("euroc"), o);
  o.dropped_fraction = 0.4;
  o.border_px = 80;
  const SimulatedSession some = simulateSession(simulatedRig("euroc"), o);
  const auto& kept = some.session.cameras[1].views;
  EXPECT_NEAR(static_cast<double>(kept.size()), 0.6 * 80, 4 * std::sqrt(80 * 0.24));
  std::size_t k = 0;
  int compared = 0;
  for (const ImageView& view : kept) {
    const auto& full = all.session.cameras[1].views;
    while (full[k].t != view.t) ++k;
    for (const Corner& c : view.corners) {
      const auto same = std::find_if(full[k].corners.begin(), full[k].corners.end(),
                                     [&](const Corner& other) { return other.id == c.id; });
      ASSERT_NE(same, full[k].corners.end());
      ASSERT_EQ(same->uv, c.uv);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(SimulateSession, JitterSeparatesTheCamerasStamps) {
  SimulationOptions o = shortOptions();
  o.stamp_jitter_s = 200e-6;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), o);
  TimeNs largest = 0;
  int equal = 0;
  for (std::size_t k = 0; k < s.frame_stamps.size(); ++k) {
    const TimeNs a = s.session.cameras[0].views[k].t;
    const TimeNs b = s.session.cameras[1].views[k].t;
    EXPECT_LE(std::abs(a - s.frame_stamps[k]), 100'000);
    largest = std::max(largest, std::abs(a - b));
    equal += a == b;
  }
  EXPECT_GT(largest, 100'000);
  EXPECT_EQ(equal, 0);
}

TEST(SimulateSession, StatesAreTheTruthAtTheFrames) {
  const SimulatedSession s = simulateSession(simulatedRig("d435i"), shortOptions());
  ASSERT_EQ(s.states.size(), s.frame_stamps.size());
  ASSERT_EQ(s.states.size(), 60U);  // 4 s at 15 Hz
  const Transform T_FC0 = s.cameraPose(0, s.frame_stamps[7]);
  const Transform expected = s.states[7].T_FS * s.truth.imu->T_SC0;
  EXPECT_LE(boxminus(T_FC0, expected).norm(), 1e-14);
  const TimeNs exposed = s.frame_stamps[7] + toNanoseconds(s.truth.imu->timeOffset());
  EXPECT_LE((s.motionAtImuTime(exposed).v_F - s.states[7].v_F).norm(), 1e-8);
}

TEST(SimulateSession, GravityPointsDownInTheWorld) {
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), shortOptions());
  const Transform T_WF = s.T_WF();
  EXPECT_LE((T_WF.R * s.gravity_F - Eigen::Vector3d(0, 0, -9.80655)).norm(), 1e-14);
  EXPECT_NEAR(T_WF.R.determinant(), 1, 1e-14);
}

TEST(SimulateSession, RefusesOptionsOutOfRangeByName) {
  const auto messageOf = [](const SimulationOptions& o) -> std::string {
    try {
      (void)simulateSession(simulatedRig("euroc"), o);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  SimulationOptions o = shortOptions();
  o.corner_sigma_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(messageOf(o), testing::HasSubstr("corner_sigma_px"));
  o = shortOptions();
  o.outlier_fraction = 1.5;
  EXPECT_THAT(messageOf(o), testing::HasSubstr("outlier_fraction is 1.5; expected"));
  SimulatedRig blind = simulatedRig("euroc");
  blind.calibration.imu.reset();
  EXPECT_THROW((void)simulateSession(blind, shortOptions()), InputError);
}

}  // namespace
}  // namespace plumbline
