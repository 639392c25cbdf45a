// SPDX-License-Identifier: BSD-3-Clause
// A flight in closed form, and what a rig's sensors say of it.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/simulate_flight.h"

namespace plumbline {
namespace {

FlightMotion motionOf(std::uint64_t seed, double duration_s = 40) {
  FlightOptions options;
  options.seed = seed;
  return {simulatedRig("euroc"), duration_s, options};
}

// Central differences of the pose against the velocities, of the velocities against the
// accelerations: truncation h^2 / 6 of third derivatives below 1e3 leaves 2e-6, rounding 1e-10.
TEST(FlightMotion, DerivativesAreThoseOfThePose) {
  constexpr double h = 1e-4;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const FlightMotion motion = motionOf(seed);
    for (double t = -0.4; t < 40; t += 0.0371) {
      const MotionState a = motion.at(t - h), m = motion.at(t), b = motion.at(t + h);
      EXPECT_LT(((b.T_FB.t - a.T_FB.t) / (2 * h) - m.v_F).norm(), 1e-5) << t;
      EXPECT_LT(((b.v_F - a.v_F) / (2 * h) - m.a_F).norm(), 1e-5) << t;
      const Eigen::Vector3d turn = logSO3(a.T_FB.R.transpose() * b.T_FB.R) / (2 * h);
      EXPECT_LT((turn - m.omega_B).norm(), 1e-5) << t;
      EXPECT_LT(((b.omega_B - a.omega_B) / (2 * h) - m.alpha_B).norm(), 1e-4) << t;
    }
  }
}

TEST(FlightMotion, StandsInItsRestsAndTurnsFastBetween) {
  const FlightMotion motion = motionOf(4);
  ASSERT_EQ(motion.rests().size(), 3U);
  double slow = 0, fast = 0;
  for (double t = 0; t < 40; t += 0.01) {
    const MotionState m = motion.at(t);
    const bool rests =
        std::any_of(motion.rests().begin(), motion.rests().end(),
                    [&](const auto& rest) { return t >= rest.first && t <= rest.second; });
    if (rests) {
      EXPECT_EQ(m.v_F.norm(), 0) << t;
      EXPECT_EQ(m.omega_B.norm(), 0) << t;
      slow += 0.01;
    }
    fast = std::max(fast, m.omega_B.norm());
    EXPECT_LT(std::abs(m.T_FB.t.x()), 0.46 * 4 * 1.1) << t;  // within the room
    EXPECT_LT(std::abs(m.T_FB.t.y()), 0.46 * 3 * 1.1) << t;
    EXPECT_LT(std::abs(m.T_FB.t.z() - 1.5), 0.6 * 1.5) << t;
  }
  EXPECT_NEAR(slow, 2 + 2 * 1.5, 0.05);
  EXPECT_GT(fast, 2.5);
  EXPECT_LT(fast, 5);
}

// A flight too short for rests and turns has fewer of them, none of which overlap.
TEST(FlightMotion, TakesAsManyRestsAsFit) {
  EXPECT_EQ(motionOf(1, 5).rests().size(), 1U);
  EXPECT_EQ(motionOf(1, 12).rests().size(), 2U);
}

SimulatedFlight exactFlight(std::uint64_t seed, double duration_s = 8) {
  SimulationOptions simulation;
  simulation.seed = seed;
  simulation.duration_s = duration_s;
  simulation.imu_noise = false;
  FlightOptions flight;
  flight.seed = seed;
  TrackOptions tracks;
  tracks.sigma_px = 0;
  return simulateFlight(simulatedRig("tumvi"), simulation, flight, tracks);
}

TEST(SimulatedFlight, TracksAreTheLandmarksThroughTheLens) {
  const SimulatedFlight flight = exactFlight(1);
  const SimulatedSession& r = flight.recording;
  std::size_t sightings = 0;
  for (std::size_t c = 0; c < 2; ++c) {
    for (const ImageView& view : r.session.cameras[c].views) {
      const Transform T_FC = r.cameraPose(static_cast<int>(c), view.t);
      for (const Corner& point : view.corners) {
        const int landmark = flight.landmark_of[static_cast<std::size_t>(point.id)];
        const auto uv =
            project(r.truth.cameras[c].intrinsics,
                    T_FC.inverse() * flight.landmarks[static_cast<std::size_t>(landmark)]);
        ASSERT_TRUE(uv);
        EXPECT_LT((*uv - point.uv).norm(), 1e-9);
        ++sightings;
      }
    }
  }
  EXPECT_GT(sightings, 160 * 150U);
}

// A track that is gone does not come back, and the numbers of points followed stay.
TEST(SimulatedFlight, ATrackHasOneLife) {
  const SimulatedFlight flight = exactFlight(2);
  std::set<int> gone, alive;
  for (const ImageView& view : flight.recording.session.cameras[0].views) {
    std::set<int> seen;
    for (const Corner& point : view.corners) {
      EXPECT_EQ(gone.count(point.id), 0U);
      seen.insert(point.id);
    }
    for (const int id : alive) {
      if (seen.count(id) == 0) gone.insert(id);
    }
    alive = seen;
    EXPECT_GE(seen.size(), 120U);
  }
  EXPECT_GT(gone.size(), 100U);  // 150 with 6 s each, and the turns
}

// At rest the accelerometer reads the reaction to gravity, turned into S; the walls are where the
// box is.
TEST(SimulatedFlight, ImuAndRoomAreInTheWorld) {
  const SimulatedFlight flight = exactFlight(3);
  const SimulatedSession& r = flight.recording;
  const ImuSample& first = r.session.imu->samples.front();
  const Eigen::Vector3d up = r.motionAtImuTime(first.t).T_FB.R * (first.accel - r.biases[0].accel);
  EXPECT_LT((up - Eigen::Vector3d(0, 0, r.truth.imu->gravity_m_s2)).norm(), 1e-12);
  EXPECT_LT((r.T_WF().R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  for (const Eigen::Vector3d& p : flight.landmarks) {
    const Eigen::Vector3d part =
        (p - Eigen::Vector3d(0, 0, 1.5)).cwiseAbs().cwiseQuotient(Eigen::Vector3d(4, 3, 1.5));
    EXPECT_NEAR(part.maxCoeff(), 1, 1e-12);
  }
}

// Options that disturb one thing leave the numbers of the others.
TEST(SimulatedFlight, NoiseOfTracksLeavesTheImuAlone) {
  SimulationOptions simulation;
  simulation.duration_s = 3;
  TrackOptions noisy;
  noisy.outlier_share = 0.1;
  const auto rig = simulatedRig("euroc");
  const SimulatedFlight a = simulateFlight(rig, simulation, {}, {});
  const SimulatedFlight b = simulateFlight(rig, simulation, {}, noisy);
  ASSERT_EQ(a.recording.session.imu->samples.size(), b.recording.session.imu->samples.size());
  EXPECT_EQ(a.recording.session.imu->samples.back().gyro,
            b.recording.session.imu->samples.back().gyro);
  EXPECT_EQ(a.landmark_of, b.landmark_of);
  EXPECT_NE(a.recording.session.cameras[0].views[0].corners.size(), 0U);
}

TEST(SimulatedFlight, OptionsOutOfRangeAreNamed) {
  FlightOptions flight;
  flight.turn_s = 0;
  EXPECT_THROW(flight.check(), InputError);
  TrackOptions tracks;
  tracks.sigma_px = -1;
  EXPECT_THROW(tracks.check(), InputError);
}

}  // namespace
}  // namespace plumbline
