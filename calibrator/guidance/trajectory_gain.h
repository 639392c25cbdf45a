// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/guidance/lissajous.h"
#include "calibrator/window/camera_imu_window.h"

namespace plumbline {

/// How a trajectory would be recorded.
struct TrajectoryRecording {
  AprilGrid target;
  double camera_rate_hz = 20;
  double imu_rate_hz = 200;
  ImuNoise noise;
  double gravity_m_s2 = 9.80655;
  double pixel_sigma = 1;     ///< standard deviation of a corner, per axis [px]
  int min_corners = 16;       ///< views of one camera with fewer count for nothing
  double border_px = 5;       ///< tags closer to the image's border are not seen
  double min_tag_px = 8;      ///< nor are tags with a side shorter than this
  double pause_s = 2;         ///< from now to the trajectory's first frame
  bool score_offset = false;  ///< the time offset counts beside T_SC0
};

/// What a trajectory's measurements would add, about T_SC0 (and the time offset), to what is known
/// now: 0.5 (log det after - log det before) [nats].
///
/// Camera frames and IMU samples are simulated without noise along the trajectory at the present
/// estimate: corners through T_FC0 and the cameras' extrinsics, the IMU through T_SC0, with the
/// present biases, gravity and time offset. The trajectory brings states of its own (a pose, a
/// velocity and biases with every frame), all marginalised. Shared with the present are T_SC0, the
/// time offset, the direction of gravity, and the biases: those of the trajectory's first frame
/// follow from the present ones by their walk over `pause_s`. No pose or velocity is carried over.
/// Cameras are held. Information is that of the batch (informationAt()), without loss, for
/// residuals are zero.
class TrajectoryScorer {
 public:
  explicit TrajectoryScorer(TrajectoryRecording recording) : recording_(std::move(recording)) {}

  /// Empty where nothing can be said: too few corners along the trajectory, or something is not
  /// determined.
  std::optional<double> gainNats(const LissajousTrajectory& trajectory,
                                 const WindowKnowledge& now) const;
  /// Of each; NaN where gainNats() is empty. Equal for any number of threads.
  std::vector<double> gainsNats(const std::vector<LissajousTrajectory>& trajectories,
                                const WindowKnowledge& now, int threads = 1) const;

 private:
  TrajectoryRecording recording_;
};

/// A trajectory as a problem: frames with the corners that the cameras would see, and IMU samples,
/// all exact; the estimate is the truth.
struct SimulatedTrajectory {
  CameraImuProblem problem;
  CameraImuEstimate estimate;
};
SimulatedTrajectory simulateTrajectory(const LissajousTrajectory& trajectory,
                                       const WindowKnowledge& now,
                                       const TrajectoryRecording& recording);

}  // namespace plumbline
