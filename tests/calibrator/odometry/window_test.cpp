// SPDX-License-Identifier: BSD-3-Clause
// What a window is made of: links, predictions, sightings and points, by values computed by hand.
#include "calibrator/odometry/window.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/calibrator/odometry/exact_window.h"

namespace plumbline {
namespace {

using test::ExactWindow;
using test::swingingSamples;

constexpr TimeNs kMillisecondNs = 1'000'000;

TEST(Window, FindsAFrameByItsSerialUntilItHasLeft) {
  Window window;
  for (const std::int64_t serial : {3, 5, 8}) {
    window.frames.emplace_back().serial = serial;
  }
  EXPECT_EQ(window.indexOf(3), 0);
  EXPECT_EQ(window.indexOf(8), 2);
  for (const std::int64_t left : {2, 4, 9}) EXPECT_EQ(window.indexOf(left), -1) << left;
}

/// Samples from 0 to 2 s in the IMU's clock, which is 0.1 s ahead of the camera's.
struct LinkExample {
  RigModel rig = RigModel::of(simulatedRig("euroc").calibration);
  std::vector<ImuSample> samples = swingingSamples();
  LinkExample() { rig.time_offset_s = 0.1; }

  bool links(TimeNs from, TimeNs to, double max_gap_s = 0.1) const {
    return imuLink(samples, rig, from, to, {}, max_gap_s).has_value();
  }
};

TEST(ImuLink, TheSamplesMustReachBothEndsByTheirOwnClock) {
  const LinkExample x;
  EXPECT_TRUE(x.links(-100 * kMillisecondNs, 400 * kMillisecondNs));
  EXPECT_FALSE(x.links(-101 * kMillisecondNs, 400 * kMillisecondNs));
  EXPECT_TRUE(x.links(400 * kMillisecondNs, 1900 * kMillisecondNs));
  EXPECT_FALSE(x.links(400 * kMillisecondNs, 1901 * kMillisecondNs));
}

TEST(ImuLink, APauseBreaksItWhereverItTouchesTheWindow) {
  LinkExample x;
  std::erase_if(x.samples, [](const ImuSample& s) {
    return s.t > 500 * kMillisecondNs && s.t < 600 * kMillisecondNs;
  });
  EXPECT_TRUE(x.links(300 * kMillisecondNs, 700 * kMillisecondNs, 0.1))
      << "no longer than is allowed";
  EXPECT_FALSE(x.links(300 * kMillisecondNs, 700 * kMillisecondNs, 0.099));
  EXPECT_FALSE(x.links(300 * kMillisecondNs, 450 * kMillisecondNs, 0.05))
      << "the window ends within it";
  EXPECT_FALSE(x.links(450 * kMillisecondNs, 700 * kMillisecondNs, 0.05))
      << "the window begins within it";
  EXPECT_TRUE(x.links(100 * kMillisecondNs, 400 * kMillisecondNs, 0.05));
  EXPECT_TRUE(x.links(500 * kMillisecondNs, 700 * kMillisecondNs, 0.05));
}

// Integrated anew at these biases the motion would be the same, to first order.
TEST(MotionAt, FollowsTheBiasesOfTheState) {
  const LinkExample x;
  const auto link = imuLink(x.samples, x.rig, 100 * kMillisecondNs, 600 * kMillisecondNs, {}, 0.1);
  ASSERT_TRUE(link);
  ImuState state;
  state.gyro_bias << 1e-3, -2e-3, 1.5e-3;
  state.accel_bias << 0.02, 0.01, -0.03;
  const Preintegration moved = motionAt(*link, state);
  const auto anew = preintegrate(x.samples, {link->from, link->to, 0.1}, biasOf(state));
  ASSERT_TRUE(anew);
  const auto share = [](double error, double change) { return error / change; };
  const Preintegration& old = link->motion;
  EXPECT_LT(share(rotationAngle(moved.R.transpose() * anew->R),
                  rotationAngle(old.R.transpose() * anew->R)),
            0.01);
  EXPECT_LT(share((moved.v - anew->v).norm(), (old.v - anew->v).norm()), 0.01);
  EXPECT_LT(share((moved.p - anew->p).norm(), (old.p - anew->p).norm()), 0.01);
}

/// Readings that do not change, over half a second.
ImuState afterHalfASecond(const ImuState& from, const Eigen::Vector3d& gyro,
                          const Eigen::Vector3d& accel) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 200; ++k) samples.push_back({5 * kMillisecondNs * k, gyro, accel});
  RigModel rig = RigModel::of(simulatedRig("euroc").calibration);
  rig.time_offset_s = 0;
  const auto link =
      imuLink(samples, rig, 100 * kMillisecondNs, 600 * kMillisecondNs, biasOf(from), 0.1);
  return predicted(from, link.value(), 10);
}

TEST(Predicted, FallsFreelyWhereNothingIsFelt) {
  ImuState from;
  from.T_FS = {expSO3({0.3, -0.2, 0.5}), {1, 2, 3}};
  from.v_F << 1, 0, 4;
  const ImuState to = afterHalfASecond(from, {0.2, 0.4, -0.6}, {0, 0, 0});
  EXPECT_LT((to.v_F - Eigen::Vector3d(1, 0, 4 - 5)).norm(), 1e-12);
  EXPECT_LT((to.T_FS.t - Eigen::Vector3d(1.5, 2, 3 + 2 - 1.25)).norm(), 1e-12);
  // Rates are those of the body: the turn comes on the right.
  const Eigen::Matrix3d R = from.T_FS.R * expSO3({0.1, 0.2, -0.3});
  EXPECT_LT(rotationAngle(R.transpose() * to.T_FS.R), 1e-9);
}

TEST(Predicted, ForcesAreFeltInTheBodyAndBiasesAreTakenOff) {
  ImuState from;
  from.T_FS.R = expSO3({0, 0, std::numbers::pi / 2});  // x of the body is y of the world
  from.accel_bias << 0.5, 0, 0;
  from.gyro_bias << 0, 0.1, 0;
  const ImuState to = afterHalfASecond(from, {0, 0.1, 0}, {2.5, 0, 10});
  EXPECT_LT((to.v_F - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((to.T_FS.t - Eigen::Vector3d(0, 0.25, 0)).norm(), 1e-12);
  EXPECT_LT(rotationAngle(from.T_FS.R.transpose() * to.T_FS.R), 1e-9);
  EXPECT_EQ(to.accel_bias, from.accel_bias);
}

TEST(RigModel, TakesTheFirstCamerasAndTheOffsetOfCamera0) {
  Calibration calibration = simulatedRig("euroc").calibration;
  calibration.imu->time_offsets = {{0.004}, {0.009, true}};
  calibration.imu->gravity_m_s2 = 9.7;
  const RigModel both = RigModel::of(calibration), one = RigModel::of(calibration, 1);
  ASSERT_EQ(both.cameras.size(), 2U);
  EXPECT_EQ(RigModel::of(calibration, 5).cameras.size(), 2U);
  ASSERT_EQ(one.cameras.size(), 1U);
  EXPECT_EQ(one.cameras[0].projection, calibration.cameras[0].intrinsics.projection);
  EXPECT_EQ(both.time_offset_s, 0.004);
  EXPECT_EQ(both.gravity_m_s2, 9.7);
  // A point of camera 1 by way of camera 0.
  const Eigen::Vector3d p(0.3, -0.1, 2);
  const Eigen::Vector3d by_camera_0 = calibration.imu->T_SC0 * (calibration.cameras[1].T_C0Ci * p);
  EXPECT_LT((both.T_SC[1] * p - by_camera_0).norm(), 1e-12);
  calibration.cameras.clear();
  EXPECT_THROW(RigModel::of(calibration), InputError);
}

// Weights are inverse densities: of a calibration that states none the IMU would be beyond doubt,
// and the odometry would lose its track for it.
TEST(RigModel, NeedsEveryNoiseDensity) {
  for (double ImuNoise::*density : {&ImuNoise::gyro_density, &ImuNoise::gyro_random_walk,
                                    &ImuNoise::accel_density, &ImuNoise::accel_random_walk}) {
    Calibration calibration = simulatedRig("euroc").calibration;
    calibration.imu->noise.*density = 0;
    EXPECT_THROW(RigModel::of(calibration), InputError);
  }
}

TEST(SightingError, WhatIsBehindTheRayOrAtTheLensHasNone) {
  const ExactWindow x(1);
  const Transform& T_WS = x.window.frames[0].state.T_FS;
  const Sighting seen = x.sighted(x.ahead(0, 0.1, 0.1, 2), 0, 0).seen;
  const auto known = [&](double depth) {
    return sightingError(seen, x.rig, T_WS, x.ahead(0, 0.1, 0.1, depth)).has_value();
  };
  EXPECT_TRUE(known(0.1));
  EXPECT_FALSE(known(0.015));
  EXPECT_FALSE(known(-2));
}

// First estimates: where the derivatives are taken is not where the error is.
TEST(SightingResidual, HasItsErrorAtTheStateAndItsDerivativesAtTheFirstEstimate) {
  const ExactWindow x(2);
  const Transform &now = x.window.frames[0].state.T_FS, &first = x.window.frames[1].state.T_FS;
  const Eigen::Vector3d p = x.ahead(1, 0.1, -0.1, 2);
  const Sighting seen = x.sighted(p, 0, 1).seen;
  const auto mixed = sightingResidual(seen, x.rig, now, first, p);
  ASSERT_TRUE(mixed);
  const auto at_first = sightingResidual(seen, x.rig, first, first, p);
  EXPECT_LT(mixed->e.norm(), 1e-9);
  EXPECT_GT(at_first->e.norm(), 10);
  EXPECT_EQ(mixed->J_pose, at_first->J_pose);
  EXPECT_EQ(mixed->J_point, at_first->J_point);
}

TEST(Triangulated, IsThePointWhereTheRaysMeet) {
  const ExactWindow x(3);
  const Eigen::Vector3d p = x.ahead(0, 0.1, -0.15, 3);
  std::vector<LandmarkSighting> sightings;
  for (const std::size_t frame : {0, 1, 2}) sightings.push_back(x.sighted(p, frame, 1));
  const auto found = triangulated(x.window, x.rig, sightings, {});
  ASSERT_TRUE(found);
  EXPECT_LT((*found - p).norm(), 1e-9);
  // A frame that has left says nothing, right or wrong.
  sightings.push_back({99, x.sighted(x.ahead(0, -0.2, 0.2, 3), 0, 0).seen});
  EXPECT_EQ(triangulated(x.window, x.rig, sightings, {}), found);
}

TEST(Triangulated, NeedsParallaxAndADepthWithinItsLimits) {
  const ExactWindow x(1);
  const double baseline = (x.rig.T_SC[0].t - x.rig.T_SC[1].t).norm();
  const auto found = [&](double depth_m, const TriangulationLimits& limits = {}) {
    const Eigen::Vector3d p = x.ahead(0, 0, 0, depth_m);
    return triangulated(x.window, x.rig, {x.sighted(p, 0, 0), x.sighted(p, 0, 1)}, limits)
        .has_value();
  };
  // Rays meet at baseline over depth: 8 mrad are needed.
  EXPECT_TRUE(found(baseline / 0.0085));
  EXPECT_FALSE(found(baseline / 0.0075));
  TriangulationLimits limits;
  limits.max_depth_m = 3;
  limits.min_depth_m = 1;
  EXPECT_TRUE(found(2, limits));
  EXPECT_FALSE(found(3.5, limits));
  EXPECT_FALSE(found(0.8, limits));
}

TEST(Triangulated, RefusesRaysThatMeetBehindOrNotAtAll) {
  const ExactWindow x(1);
  const Eigen::Vector3d p = x.ahead(0, 0, 0, 3);
  const auto found = [&](const Eigen::Vector2d& off_px) {
    return triangulated(x.window, x.rig, {x.sighted(p, 0, 0), x.sighted(p, 0, 1, off_px)}, {})
        .has_value();
  };
  EXPECT_TRUE(found({0, 0}));
  // Camera 1 stands beside camera 0: across the baseline the rays miss each other, and each
  // sighting takes half of it. Five deviations are allowed, of one pixel here.
  EXPECT_TRUE(found({0, 8}));
  EXPECT_FALSE(found({0, 14}));
  // Along it a point of 3 m is some 17 px off infinity: beyond, the rays meet behind.
  EXPECT_FALSE(found({40, 0}));
}

}  // namespace
}  // namespace plumbline
