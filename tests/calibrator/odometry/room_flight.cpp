// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/odometry/room_flight.h"

#include <Eigen/Geometry>
#include <cmath>

namespace plumbline {
namespace {

SimulatedFlight simulated(const SimulatedRig& rig, const RoomFlightOptions& o) {
  SimulationOptions simulation;
  simulation.seed = o.seed;
  simulation.duration_s = o.duration_s;
  simulation.camera_rate_hz = o.camera_rate_hz;
  simulation.imu_noise = o.imu_noise;
  if (!o.imu_noise) simulation.initial_gyro_bias = simulation.initial_accel_bias.setZero();
  FlightOptions flight;
  flight.seed = o.seed;
  flight.first_rest_s = o.rest_s;
  flight.turns = o.turns;
  TrackOptions tracks;
  tracks.sigma_px = o.pixel_sigma;
  tracks.tracks = o.tracks;
  tracks.outlier_share = o.outlier_share;
  return simulateFlight(rig, simulation, flight, tracks);
}

}  // namespace

RoomFlight::RoomFlight(const SimulatedRig& rig, const RoomFlightOptions& options) {
  const SimulatedFlight flight = simulated(rig, options);
  const SimulatedSession& recording = flight.recording;
  samples = recording.session.imu->samples;
  length_m = flight.length_m;
  for (std::size_t k = 0; k < recording.frame_stamps.size(); ++k) {
    FrameTracks frame{recording.frame_stamps[k], {}};
    for (std::size_t c = 0; c < recording.session.cameras.size(); ++c) {
      for (const Corner& point : recording.session.cameras[c].views[k].corners) {
        frame.points.push_back({point.id, static_cast<int>(c), point.uv});
      }
    }
    frames.push_back(std::move(frame));
    truth.push_back(recording.states[k].T_FS);
  }
}

RoomFlightOptions flightOfTenSeconds(double pixel_sigma) {
  RoomFlightOptions options;
  options.duration_s = 10;
  options.pixel_sigma = pixel_sigma;
  options.imu_noise = pixel_sigma > 0;
  return options;
}

OdometryResult flownBy(const RoomFlight& flight, const Calibration& calibration,
                       const OdometryOptions& options, int cameras) {
  Odometry odometry(RigModel::of(calibration, cameras), flight.samples, options);
  for (FrameTracks frame : flight.frames) {
    std::erase_if(frame.points, [&](const TrackPoint& p) { return p.camera >= cameras; });
    odometry.step(frame);
  }
  return odometry.result();
}

double alignedRmse(const std::vector<Eigen::Vector3d>& estimate,
                   const std::vector<Eigen::Vector3d>& truth) {
  Eigen::Matrix3Xd from(3, estimate.size()), to(3, truth.size());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = estimate[i];
    to.col(static_cast<Eigen::Index>(i)) = truth[i];
  }
  const Eigen::Matrix4d T = Eigen::umeyama(from, to, false);
  const Eigen::Matrix3Xd d =
      (T.topLeftCorner<3, 3>() * from).colwise() + Eigen::Vector3d(T.topRightCorner<3, 1>()) - to;
  return std::sqrt(d.colwise().squaredNorm().mean());
}

}  // namespace plumbline
