// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "calibrator/guidance/trajectories/trajectory_gain.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/window/imu_window_recording.h"

namespace plumbline::test {

/// How a trajectory is recorded after a recording, by a rig whose truth is known.
struct RecordedTrajectoryOptions {
  double camera_rate_hz = 20;
  double imu_rate_hz = 200;
  double corner_sigma_px = 0;  ///< 0: exact
  bool imu_noise = false;
  std::uint64_t seed = 1;
};

/// Adds noise to vectors of a stream of its own.
class VectorNoise {
 public:
  VectorNoise(std::uint64_t seed, RandomPurpose purpose, double sigma)
      : random_(seed, purpose), sigma_(sigma) {}
  Eigen::Vector3d next() {
    const double x = random_.normal();
    const double y = random_.normal();
    return sigma_ * Eigen::Vector3d(x, y, random_.normal());
  }

 private:
  RandomStream random_;
  double sigma_;
};

/// What a rig at `truth` (its last state's biases are those of the IMU) sees and reads along a
/// trajectory that starts kPause_s after `last`: the frames, with views appended to `views`.
struct RecordedTrajectory {
  std::vector<Frame> frames;
  std::vector<std::vector<ImageView>> views;  // per camera
  std::vector<ImuSample> samples;
  std::vector<ImuState> states;  // the truth
};

inline std::vector<ImuSample> samplesAlong(const LissajousTrajectory& trajectory,
                                           const WindowRecording& r, TimeNs start,
                                           const RecordedTrajectoryOptions& o) {
  const CameraImuEstimate& e = r.truth;
  const ImuNoise& noise = r.problem.noise;
  const double root = o.imu_noise ? std::sqrt(o.imu_rate_hz) : 0;
  VectorNoise gyro(o.seed, RandomPurpose::kGyroNoise, noise.gyro_density * root);
  VectorNoise accel(o.seed, RandomPurpose::kAccelNoise, noise.accel_density * root);
  std::vector<ImuSample> samples;
  const int count = static_cast<int>((trajectory.durationS() + 0.2) * o.imu_rate_hz) + 2;
  for (int k = 0; k < count; ++k) {
    const double t_s = k / o.imu_rate_hz - 0.1;
    const MotionState m = attached(trajectory.cameraAt(t_s), e.T_SC0.inverse());
    const Eigen::Vector3d force = m.a_F - r.problem.gravity_m_s2 * e.gravity_direction;
    samples.push_back({start + toNanoseconds(t_s + e.timeOffset()),
                       m.omega_B + e.states.back().gyro_bias + gyro.next(),
                       m.T_FB.R.transpose() * force + e.states.back().accel_bias + accel.next()});
  }
  return samples;
}

inline RecordedTrajectory recordAlong(const LissajousTrajectory& trajectory,
                                      const WindowRecording& r, TimeNs last,
                                      const RecordedTrajectoryOptions& o) {
  RecordedTrajectory out;
  const CameraImuEstimate& e = r.truth;
  const TimeNs start = last + toNanoseconds(TrajectoryRecording::kPause_s);
  SimulationOptions seen;
  RandomStream random(o.seed, RandomPurpose::kCornerNoise);
  out.views.resize(e.cameras.size());
  const int count = static_cast<int>(trajectory.durationS() * o.camera_rate_hz) + 1;
  for (int k = 0; k < count; ++k) {
    const double t_s = k / o.camera_rate_hz;
    const MotionState camera = trajectory.cameraAt(t_s);
    const MotionState sensor = attached(camera, e.T_SC0.inverse());
    Frame frame{start + toNanoseconds(t_s), {}};
    for (std::size_t c = 0; c < e.cameras.size(); ++c) {
      ImageView view{frame.t, visibleCorners(e.cameras[c].intrinsics,
                                             camera.T_FB * e.cameras[c].T_C0Ci, seen)};
      for (Corner& corner : view.corners) {
        const double du = random.normal();
        corner.uv += o.corner_sigma_px * Eigen::Vector2d(du, random.normal());
      }
      frame.view.push_back(static_cast<int>(out.views[c].size()));
      out.views[c].push_back(std::move(view));
    }
    out.frames.push_back(std::move(frame));
    out.states.push_back(
        {sensor.T_FB, sensor.v_F, e.states.back().gyro_bias, e.states.back().accel_bias});
  }
  out.samples = samplesAlong(trajectory, r, start, o);
  return out;
}

/// The recording's frames and those of the trajectory after them as one problem, joined by the
/// biases' walk; the estimate is the truth.
struct JointProblem {
  CameraImuProblem problem;
  CameraImuEstimate truth;
};
inline JointProblem jointProblem(const WindowRecording& r, const RecordedTrajectory& after) {
  JointProblem joint{r.problem, r.truth};
  CameraImuProblem& p = joint.problem;
  for (std::size_t c = 0; c < p.corners.size(); ++c) {
    std::vector<ImageView> views = r.simulated.session.cameras[c].views;
    const int recorded = static_cast<int>(views.size());
    views.insert(views.end(), after.views[c].begin(), after.views[c].end());
    p.corners[c] = PackedCorners(r.simulated.session.target, views);
    for (std::size_t k = 0; k < after.frames.size(); ++k) {
      if (c == 0) p.frames.push_back(after.frames[k]);
      p.frames[r.problem.frames.size() + k].view[c] += recorded;
    }
  }
  p.links.push_back(FrameLink::kBiasWalk);
  p.links.resize(p.frames.size() - 1, FrameLink::kInertial);
  p.weights.assign(p.frames.size(), 1);
  p.samples.insert(p.samples.end(), after.samples.begin(), after.samples.end());
  auto& states = joint.truth.states;
  states.insert(states.end(), after.states.begin(), after.states.end());
  return joint;
}

inline TrajectoryRecording plannedRecording(const WindowRecording& r,
                                            const RecordedTrajectoryOptions& o) {
  TrajectoryRecording planned;
  planned.target = r.simulated.session.target;
  planned.camera_rate_hz = o.camera_rate_hz;
  planned.imu_rate_hz = o.imu_rate_hz;
  planned.noise = r.problem.noise;
  planned.gravity_m_s2 = r.problem.gravity_m_s2;
  planned.pixel_sigma = r.problem.pixel_sigma;
  return planned;
}

}  // namespace plumbline::test
