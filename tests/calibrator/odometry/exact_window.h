// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/odometry/window.h"
#include "calibrator/simulate/rig.h"

namespace plumbline::test {

/// A sensor that swings and turns: 200 Hz, in the IMU's clock from 0 to 2 s.
inline std::vector<ImuSample> swingingSamples() {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 400; ++k) {
    const double t = 0.005 * k;
    samples.push_back({5'000'000LL * k,
                       {0.3 * std::sin(3 * t), 0.5 * std::cos(2 * t), -0.4 * std::sin(4 * t + 1)},
                       {std::sin(5 * t), 1.5 * std::cos(4 * t), 9.8 + std::sin(3 * t)}});
  }
  return samples;
}

/// A rig whose frames lie where the IMU leads it, so that states and IMU agree to the last bit, and
/// that sees points without noise: at these states every term of a window is zero.
struct ExactWindow {
  RigModel rig = RigModel::of(simulatedRig("euroc").calibration);
  std::vector<ImuSample> samples = swingingSamples();
  Window window;

  /// Frames `interval_s` apart, each linked to the next; no landmarks yet.
  explicit ExactWindow(int frames, double interval_s = 0.2) {
    rig.time_offset_s = 0.05;
    ImuState state;
    state.T_FS = {Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3), {0.5, -0.3, 1.2}};
    state.v_F << 0.4, 0.2, -0.1;
    state.gyro_bias << 0.01, -0.02, 0.005;
    state.accel_bias << 0.05, 0.02, -0.04;
    for (int k = 0; k < frames; ++k) {
      OdometryFrame frame;
      frame.serial = 10 + k;
      frame.t = toNanoseconds(0.1 + interval_s * k);
      frame.keyframe = true;
      if (k > 0) {
        OdometryFrame& last = window.frames.back();
        last.link = imuLink(samples, rig, last.t, frame.t, biasOf(state), 0.1);
        state = predicted(last.state, *last.link, rig.gravity_m_s2);
      }
      frame.state = state;
      window.frames.push_back(frame);
    }
  }

  /// The pixel on which a camera of a frame sees the point.
  Eigen::Vector2d pixelOf(const Eigen::Vector3d& p_W, std::size_t frame, int camera) const {
    const auto c = static_cast<std::size_t>(camera);
    const Transform T_WC = window.frames[frame].state.T_FS * rig.T_SC[c];
    return project(rig.cameras[c], T_WC.inverse() * p_W).value();
  }
  LandmarkSighting sighted(const Eigen::Vector3d& p_W, std::size_t frame, int camera,
                           const Eigen::Vector2d& off_px = {0, 0}) const {
    return {window.frames[frame].serial,
            rig.sighting(camera, pixelOf(p_W, frame, camera) + off_px, 1).value()};
  }
  /// A point ahead of camera 0 at `frame`, beside its axis by tangents x and y.
  Eigen::Vector3d ahead(std::size_t frame, double x, double y, double depth_m) const {
    const Transform T_WC = window.frames[frame].state.T_FS * rig.T_SC[0];
    return T_WC * Eigen::Vector3d(depth_m * Eigen::Vector3d(x, y, 1));
  }
  /// Sixteen points, seen by both cameras in the frames from `first` to `last`.
  void addLandmarks(std::int64_t first_id, std::size_t first, std::size_t last) {
    for (int i = 0; i < 16; ++i) {
      const Eigen::Vector3d p =
          ahead(first, 0.06 * (i % 4 - 1.5), 0.06 * (i / 4 - 1.5), 2.5 + 0.1 * i);
      Landmark& landmark = window.landmarks[first_id + i];
      landmark.p_W = p;
      landmark.last_frame = window.frames[last].serial;
      for (std::size_t k = first; k <= last; ++k) {
        for (const int camera : {0, 1}) landmark.sightings.push_back(sighted(p, k, camera));
      }
    }
  }
};

}  // namespace plumbline::test
