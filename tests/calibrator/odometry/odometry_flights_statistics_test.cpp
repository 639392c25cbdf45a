// SPDX-License-Identifier: BSD-3-Clause
// Whole flights on many tracks, by two cameras, one, and fisheye lenses: too long for sanitizers.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/odometry/odometry.h"
#include "tests/calibrator/odometry/room_flight.h"

namespace plumbline {
namespace {

double ate(const OdometryResult& result, const RoomFlight& flight) {
  std::vector<Eigen::Vector3d> estimate, truth;
  std::size_t j = 0;
  for (const OdometryPose& pose : result.poses) {
    while (flight.frames[j].t < pose.t) ++j;
    estimate.push_back(pose.state.T_FS.t);
    truth.push_back(flight.truth[j].t);
  }
  return alignedRmse(estimate, truth);
}

TEST(OdometryFlights, ExactMeasurementsGiveTheFlight) {
  const SimulatedRig rig = simulatedRig("euroc");
  const RoomFlight flight(rig, flightOfTenSeconds(0));
  const OdometryResult result = flownBy(flight, rig.calibration);
  EXPECT_TRUE(result.losses.empty());
  EXPECT_GT(result.poses.size(), flight.frames.size() - 20);
  EXPECT_LT(ate(result, flight), 1e-4);
}

TEST(OdometryFlights, OneCameraFindsTheScaleFromTheImu) {
  const SimulatedRig rig = simulatedRig("euroc");
  RoomFlightOptions options = flightOfTenSeconds(0.3);
  options.rest_s = 3;
  const RoomFlight flight(rig, options);
  const OdometryResult result = flownBy(flight, rig.calibration, {}, 1);
  EXPECT_TRUE(result.losses.empty());
  ASSERT_GT(result.poses.size(), 100U);
  EXPECT_LT(ate(result, flight), 0.05);
}

TEST(OdometryFlights, FisheyeRigToo) {
  const SimulatedRig rig = simulatedRig("tumvi");
  const RoomFlight flight(rig, flightOfTenSeconds(0.3));
  const OdometryResult result = flownBy(flight, rig.calibration);
  ASSERT_GT(result.poses.size(), 100U);
  EXPECT_LT(ate(result, flight), 0.02);
}

// What nothing observes stays so: moving and turning all frames about gravity costs the prior no
// more than the gauge that the first frame was given, whatever has been marginalised since.
TEST(OdometryFlights, ThePriorKnowsNoPositionAndNoYaw) {
  const SimulatedRig rig = simulatedRig("euroc");
  const RoomFlight flight(rig, flightOfTenSeconds(0.5));
  Odometry odometry(RigModel::of(rig.calibration), flight.samples);
  std::size_t n = 0;
  for (const FrameTracks& frame : flight.frames) {
    odometry.step(frame);
    if (++n == 150) break;
  }
  const WindowPrior& prior = odometry.window().prior;
  const auto size = static_cast<Eigen::Index>(15 * prior.frames.size());
  Eigen::VectorXd yaw = Eigen::VectorXd::Zero(size), rise = yaw, tilt = yaw;
  for (std::size_t i = 0; i < prior.frames.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(15 * i);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), side = Eigen::Vector3d::UnitX();
    const ImuState& state = prior.points[i];
    yaw.segment<3>(row) = up.cross(state.T_FS.t);
    yaw.segment<3>(row + 3) = up;
    yaw.segment<3>(row + 6) = up.cross(state.v_F);
    tilt.segment<3>(row) = side.cross(state.T_FS.t);
    tilt.segment<3>(row + 3) = side;
    tilt.segment<3>(row + 6) = side.cross(state.v_F);
    rise.segment<3>(row) = up;
  }
  // The gauge is 1e-4 m and rad, so 1e8 of information; what the IMU knows of the tilt is more than
  // rounding of that, and comes on top.
  const double of_yaw = yaw.dot(prior.cost.H * yaw), of_rise = rise.dot(prior.cost.H * rise);
  EXPECT_LT(of_yaw, 1.05e8);
  EXPECT_LT(of_rise, 1.05e8);
  EXPECT_GT(tilt.dot(prior.cost.H * tilt), 1e4);
}

}  // namespace
}  // namespace plumbline
