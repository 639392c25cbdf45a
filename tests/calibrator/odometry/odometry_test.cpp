// SPDX-License-Identifier: BSD-3-Clause
// What the odometry does with flights of a few seconds. How well it flies, also with one camera and
// fisheye lenses, is in odometry_flights_statistics_test.cpp.
#include "calibrator/odometry/odometry.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/odometry/window_problem.h"
#include "tests/calibrator/odometry/room_flight.h"

namespace plumbline {
namespace {

/// Of 5 s and few tracks: for what does not depend on how well it flies.
RoomFlight sparseFlight(const SimulatedRig& rig, double pixel_sigma) {
  RoomFlightOptions options = flightOfTenSeconds(pixel_sigma);
  options.duration_s = 5;
  options.tracks = 50;
  return {rig, options};
}

TEST(Odometry, SameValuesTwice) {
  const SimulatedRig rig = simulatedRig("euroc");
  RoomFlight flight = sparseFlight(rig, 0.5);
  flight.frames.resize(60);
  const OdometryResult a = flownBy(flight, rig.calibration), b = flownBy(flight, rig.calibration);
  EXPECT_GT(a.poses.size(), 30U);
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].state.T_FS.t, b.poses[i].state.T_FS.t);
  }
}

TEST(Odometry, AGapOfTheImuIsALossThatIsTold) {
  const SimulatedRig rig = simulatedRig("euroc");
  RoomFlight flight = sparseFlight(rig, 0.3);
  const TimeNs from = flight.frames[50].t, to = flight.frames[62].t;
  std::erase_if(flight.samples, [&](const ImuSample& s) { return s.t > from && s.t < to; });
  const OdometryResult result = flownBy(flight, rig.calibration);
  ASSERT_EQ(result.losses.size(), 1U);
  EXPECT_EQ(result.losses[0].cause, OdometryLoss::kImuGap);
  EXPECT_GE(result.losses[0].t, from);
  EXPECT_LE(result.losses[0].t, to);
  EXPECT_GT(result.poses.back().t, to);  // and it began anew
}

TEST(Odometry, FramesAfterTheLastSampleAreNoLoss) {
  const SimulatedRig rig = simulatedRig("euroc");
  RoomFlight flight = sparseFlight(rig, 0.3);
  const TimeNs end = flight.frames[60].t + toNanoseconds(rig.calibration.imu->timeOffset());
  std::erase_if(flight.samples, [&](const ImuSample& s) { return s.t > end + 1'000'000; });
  const OdometryResult result = flownBy(flight, rig.calibration);
  EXPECT_TRUE(result.losses.empty());
  EXPECT_EQ(result.frames, static_cast<int>(flight.frames.size()));
  ASSERT_FALSE(result.poses.empty());
  EXPECT_GE(result.poses.back().t, flight.frames[59].t);
}

// Ten frames become poses at once, as their landmarks are counted once.
TEST(Odometry, MeanLandmarksAreThoseOfTheWindow) {
  const SimulatedRig rig = simulatedRig("euroc");
  const RoomFlight flight(rig, flightOfTenSeconds(0.3));
  Odometry odometry(RigModel::of(rig.calibration), flight.samples);
  for (const FrameTracks& frame : flight.frames) {
    odometry.step(frame);
    if (odometry.isRunning()) break;
  }
  int placed = 0;
  for (const auto& [id, landmark] : odometry.window().landmarks) placed += landmark.p_W ? 1 : 0;
  EXPECT_GT(placed, 50);
  EXPECT_EQ(odometry.result().mean_landmarks, placed);
}

// It comes to a stand while frames wait for the start: the first of them is in motion.
TEST(Odometry, AStandAtTheEndOfTheStartIsNoStandAtItsBeginning) {
  const SimulatedRig rig = simulatedRig("euroc");
  const RoomFlight flight(rig, flightOfTenSeconds(0));
  const auto stands = [&](std::size_t k) {
    return (flight.truth[k + 1].t - flight.truth[k].t).norm() < 1e-9;
  };
  std::size_t rest = 30;  // and not the one before the flight
  while (stands(rest)) ++rest;
  while (!stands(rest)) ++rest;
  OdometryOptions options;
  options.model.still_sigma_m_s = 1e-4;  // so that it would decide
  Odometry odometry(RigModel::of(rig.calibration, 1), flight.samples, options);
  std::size_t k = rest - 34;  // of 40 that one camera waits for
  for (; !odometry.isRunning() && k < rest + 20; ++k) {
    FrameTracks frame = flight.frames[k];
    std::erase_if(frame.points, [](const TrackPoint& p) { return p.camera > 0; });
    odometry.step(frame);
  }
  ASSERT_TRUE(odometry.isRunning());
  const OdometryFrame& first = odometry.window().frames.front();
  std::size_t j = 0;
  while (flight.frames[j].t < first.t) ++j;
  const double dt = secondsBetween(flight.frames[j - 1].t, flight.frames[j + 1].t);
  const double speed = (flight.truth[j + 1].t - flight.truth[j - 1].t).norm() / dt;
  EXPECT_GT(speed, 0.1);
  EXPECT_NEAR(first.state.v_F.norm(), speed, 0.05 * speed);
}

/// What the first frames saw, as the start takes it.
std::vector<StartFrame> startFrames(const RoomFlight& flight, const RigModel& rig) {
  std::vector<StartFrame> frames;
  for (std::size_t k = 0; k < 16; ++k) {
    frames.push_back({flight.frames[k].t, {}});
    for (const TrackPoint& p : flight.frames[k].points) {
      if (const auto seen = rig.sighting(p.camera, p.uv, 0.5)) {
        frames.back().seen.emplace_back(p.id, *seen);
      }
    }
  }
  return frames;
}

TEST(OdometryStart, SightingsThatDoNotFitAreRefused) {
  const SimulatedRig rig = simulatedRig("euroc");
  const RoomFlight flight(rig, flightOfTenSeconds(0.5));
  RigModel model = RigModel::of(rig.calibration);
  const std::vector<StartFrame> frames = startFrames(flight, model);
  const auto start = startEstimate(frames, flight.samples, model, {});
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->rms, 1, 0.3);
  for (Transform& T_SC : model.T_SC) T_SC.R = expSO3({0, 0, 1.2}) * T_SC.R;
  StartOptions all;
  all.max_rms = 1e6;
  const auto wrong = startEstimate(frames, flight.samples, model, all);
  ASSERT_TRUE(wrong);  // by its deviations alone
  EXPECT_GT(wrong->rms, StartOptions().max_rms);
  EXPECT_FALSE(startEstimate(frames, flight.samples, model, {}));
}

TEST(Odometry, BlindFramesAreBridgedAndThenALoss) {
  const SimulatedRig rig = simulatedRig("euroc");
  RoomFlight flight = sparseFlight(rig, 0.3);
  for (int k = 50; k < 56; ++k) flight.frames[static_cast<std::size_t>(k)].points.clear();
  EXPECT_TRUE(flownBy(flight, rig.calibration).losses.empty());
  for (int k = 56; k < 90; ++k) flight.frames[static_cast<std::size_t>(k)].points.clear();
  const OdometryResult result = flownBy(flight, rig.calibration);
  ASSERT_EQ(result.losses.size(), 1U);
  EXPECT_EQ(result.losses[0].cause, OdometryLoss::kBlind);
}

TEST(Odometry, OptionsOutOfRangeAreNamed) {
  OdometryOptions options;
  options.gate = -1;
  EXPECT_THROW(options.check(), InputError);
  const auto refuses = [](auto change, const std::string& field) {
    OdometryOptions changed;
    change(changed);
    try {
      changed.check();
    } catch (const InputError& error) {
      return std::string(error.what()).find(field) != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refuses([](auto& o) { o.model.cauchy = NAN; }, "model.cauchy"));
  EXPECT_TRUE(refuses([](auto& o) { o.model.still_sigma_m_s = 0; }, "still_sigma_m_s"));
  EXPECT_TRUE(refuses([](auto& o) { o.triangulation.min_depth_m = -1; }, "min_depth_m"));
  EXPECT_TRUE(refuses([](auto& o) { o.start.velocity_sigma = 0; }, "velocity_sigma"));
  Calibration without_imu = simulatedRig("euroc").calibration;
  without_imu.imu.reset();
  EXPECT_THROW(RigModel::of(without_imu), InputError);
}

struct SightingExample {
  RigModel rig = RigModel::of(simulatedRig("euroc").calibration);
  Transform T_WS{Eigen::Quaterniond(0.8, 0.1, -0.3, 0.2), {0.4, -0.2, 1.1}};
  Eigen::Vector3d p_C{0.3, -0.2, 2.5};
  Eigen::Vector3d p_W = T_WS * (rig.T_SC[1] * p_C);
};

TEST(Sighting, IsTheReprojectionErrorToFirstOrder) {
  const SightingExample x;
  const Eigen::Vector2d uv = *project(x.rig.cameras[1], x.p_C);
  const Eigen::Vector2d off(0.4, -0.3);
  const auto seen = x.rig.sighting(1, uv + off, 0.5);
  ASSERT_TRUE(seen);
  const auto e = sightingError(*seen, x.rig, x.T_WS, x.p_W);
  ASSERT_TRUE(e);
  EXPECT_NEAR((*e + off / 0.5).norm(), 0, 5e-3);  // second order: 0.5 px of 460
}

TEST(Sighting, DerivativesAgreeWithDifferences) {
  const SightingExample x;
  const auto seen = x.rig.sighting(1, *project(x.rig.cameras[1], x.p_C) + Eigen::Vector2d(3, 2), 1);
  const auto r = sightingResidual(*seen, x.rig, x.T_WS, x.T_WS, x.p_W);
  ASSERT_TRUE(r);
  constexpr double h = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const Vector6d d = h * Vector6d::Unit(k);
    const Eigen::Vector2d slope = (*sightingError(*seen, x.rig, boxplus(x.T_WS, d), x.p_W) -
                                   *sightingError(*seen, x.rig, boxplus(x.T_WS, -d), x.p_W)) /
                                  (2 * h);
    EXPECT_LT((slope - r->J_pose.col(k)).norm(), 1e-5 * (1 + slope.norm())) << k;
  }
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(k);
    const Eigen::Vector2d slope = (*sightingError(*seen, x.rig, x.T_WS, x.p_W + d) -
                                   *sightingError(*seen, x.rig, x.T_WS, x.p_W - d)) /
                                  (2 * h);
    EXPECT_LT((slope - r->J_point.col(k)).norm(), 1e-5 * (1 + slope.norm())) << k;
  }
}

/// Two frames of which the prior knows this of the first.
Window windowOfTwo(const Eigen::Matrix<double, 15, 15>& H) {
  Window window;
  for (std::int64_t serial : {0, 1}) {
    OdometryFrame frame;
    frame.serial = frame.t = serial;
    window.frames.push_back(frame);
    window.prior.frames.push_back(serial);
    window.prior.points.push_back(frame.state);
  }
  window.prior.cost = {Eigen::MatrixXd::Zero(30, 30), Eigen::VectorXd::Zero(30), 0};
  window.prior.cost.H.topLeftCorner<15, 15>() = H;
  return window;
}

TEST(Marginalise, AFrameThatNothingLinksTellsNothingOfTheOthers) {
  const RigModel rig = RigModel::of(simulatedRig("euroc").calibration);
  Window window = windowOfTwo(Eigen::Matrix<double, 15, 15>::Identity());
  ASSERT_TRUE(marginaliseOldest(window, {}, rig, {}));
  EXPECT_EQ(window.prior.frames, std::vector<std::int64_t>{1});
  EXPECT_EQ(window.prior.cost.H.norm(), 0);
}

TEST(Marginalise, SaysThatThePriorIsLost) {
  const RigModel rig = RigModel::of(simulatedRig("euroc").calibration);
  Eigen::Matrix<double, 15, 15> H = Eigen::Matrix<double, 15, 15>::Identity();
  H.topLeftCorner<2, 2>().setConstant(1e12);  // two coordinates that are known by their sum alone
  Window window = windowOfTwo(H);
  EXPECT_FALSE(marginaliseOldest(window, {}, rig, {}));
  EXPECT_TRUE(window.prior.frames.empty());
}

TEST(Odometry, TheWindowsCostIsASumOfSquares) {
  const SimulatedRig rig = simulatedRig("euroc");
  const RoomFlight flight(rig, flightOfTenSeconds(0.5));
  const RigModel model = RigModel::of(rig.calibration);
  Odometry odometry(model, flight.samples);
  double last = 0;
  for (std::size_t n = 0; n < 40; ++n) {
    odometry.step(flight.frames[n]);
    if (!odometry.isRunning()) continue;
    Window window = odometry.window();
    last = WindowProblem(window, model, OdometryOptions().model).cost();
    EXPECT_GT(last, 0) << n;
  }
  EXPECT_GT(last, 1000);  // with what left: thousands of sightings
}

}  // namespace
}  // namespace plumbline
