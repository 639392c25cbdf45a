// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/transform.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/simulate/motion.h"

namespace plumbline {

/// A curve in front of the target (the paper's trajectories): with theta from 0 to 1,
///   x = A sin(2 pi a theta + delta),  y = B sin(2 pi b theta),  z = sqrt(R^2 - x^2 - y^2),
/// about the target's centre, along the axes of F; A = width_ratio * w, B = height_ratio * h, with
/// w and h the target's size.
struct LissajousShape {
  std::string name;
  double a = 0, b = 0;
  double delta = 0;  ///< [rad]
  double width_ratio = 0, height_ratio = 0;
};

/// The six of the paper: "figure 8 horizontal", "figure 8 vertical", "pan horizontal", "pan
/// vertical", "diagonal 0", "diagonal 1".
std::vector<LissajousShape> lissajousShapes();

/// Of the six the one to begin with, before any can be scored: "diagonal 0" turns the sensor about
/// both axes of the image at once (measured: docs/counterfactuals.md).
LissajousShape lissajousFirst();

/// Camera 0 along a shape, looking exactly at the target's centre, and turned about the line of
/// sight by roll_rad sin(2 pi theta) from where x of the camera is parallel to the x-z plane of F
/// (the paper's trajectories have no roll). The sensor follows through T_SC0.
///
/// theta(t) = sin^2(pi t / 2T): camera and sensor are at rest at both ends (not free of
/// acceleration there); before and after they stay. Where speed, rate or acceleration of camera 0
/// or of S would exceed its limit, the whole motion is slowed by a longer duration T, which keeps
/// the path: speed and rate go with 1/T, acceleration with 1/T^2.
class LissajousTrajectory {
 public:
  LissajousTrajectory(LissajousShape shape, const AprilGrid& target, const Transform& T_SC0,
                      const LissajousOptions& options);

  const std::string& name() const { return shape_.name; }
  double durationS() const { return duration_s_; }
  /// Motion of camera 0, `t_s` after the start. Closed form; any t_s.
  MotionState cameraAt(double t_s) const;
  /// T_FC0 at `count` (>= 2) instants evenly over the duration, both ends included.
  std::vector<Transform> path(int count) const;

 private:
  void slowDown(const Transform& T_C0S, const LissajousOptions& options);

  LissajousShape shape_;
  Eigen::Vector2d centre_;
  double A_ = 0, B_ = 0, R_ = 0;  // [m]
  double roll_ = 0;               // [rad]
  double duration_s_ = 0;
};

/// All shapes as trajectories.
std::vector<LissajousTrajectory> lissajousTrajectories(const std::vector<LissajousShape>& shapes,
                                                       const AprilGrid& target,
                                                       const Transform& T_SC0,
                                                       const LissajousOptions& options);

}  // namespace plumbline
