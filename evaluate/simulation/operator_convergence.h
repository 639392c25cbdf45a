// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/transform.h"
#include "evaluate/simulation/operated_session.h"

namespace plumbline {

/// When a calibration counts as right, and how it is looked for.
struct ConvergenceOptions {
  double projection_px = 0.1;            ///< of the worst camera
  double translation_m = 1e-3;           ///< of T_SC0
  double rotation_rad = 0.05 * kDegree;  ///< likewise
  int in_a_row = 3;     ///< calibrations within the bars, from the first of which it is right
  double first_s = 2;   ///< unguided, and for the IMU: calibrated first after so long ...
  double growth = 1.1;  ///< ... and then after so many times the time (or views) before

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A calibration of what was recorded by then, held against the truth.
struct ConvergencePoint {
  double t_s = 0;  ///< since the stage began
  int views = 0;   ///< frames that it stands on
  /// trueProjectionErrorPx() of the worst camera; empty: no calibration, or of the IMU.
  std::optional<double> projection_px;
  /// Of T_SC0: distance of the origins, angle between the axes; empty likewise.
  std::optional<double> translation_m, rotation_rad;
  /// By how much points that the IMU predicts are off (ImuReprojection), from T_SC0 and the time
  /// offset; empty likewise.
  std::optional<double> reprojection_px;
  bool right = false;  ///< within the bars
};

template <class V>
void fields(V& v, ConvergencePoint& p) {
  v("t_s", p.t_s, "s", "since the stage began");
  v("views", p.views, "1", "frames of the calibration");
  v("projection_px", p.projection_px, "px", "RMS over the image against the truth, worst camera");
  v("translation_m", p.translation_m, "m", "error of T_SC0");
  v("rotation_rad", p.rotation_rad, "rad", "likewise");
  v("reprojection_px", p.reprojection_px, "px", "error of points that the IMU predicts");
  v("right", p.right, "within the bars");
}

struct StageConvergence {
  std::vector<ConvergencePoint> points;
  std::optional<double> right_s;  ///< right from then on; empty: it never was
  std::optional<int> right_views;
  std::optional<double> stopped_s;         ///< when the guide said that the stage was over
  std::optional<ConvergencePoint> at_end;  ///< of the stage
};

template <class V>
void fields(V& v, StageConvergence& s) {
  v("right_s", s.right_s, "s", "time from which it stays within the bars");
  v("right_views", s.right_views, "1", "number of frames then");
  v("stopped_s", s.stopped_s, "s", "when the guide finished the stage");
  v("at_end", s.at_end, "of the stage");
  v("points", s.points, "calibrations in the order of time");
}

struct OperatedConvergence {
  StageConvergence cameras, camera_imu;
};

template <class V>
void fields(V& v, OperatedConvergence& c) {
  v("cameras", c.cameras, "intrinsics");
  v("camera_imu", c.camera_imu, "T_SC0");
}

/// RMS over a grid on the image of the difference between where `truth` and `estimate` see
/// directions, a rotation taken out [px]; infinite where it is not defined.
double trueProjectionErrorPx(const Intrinsics& truth, const Intrinsics& estimate);

/// The views that a guide had kept after a frame.
struct KeptViews {
  double t_s = 0;           ///< since the stage began
  std::vector<int> frames;  ///< their positions
  /// What the guide predicted with them: projection_px of its Decision, in the camera-IMU stage
  /// error_px.
  std::optional<double> predicted_px;
  bool finished = false;  ///< with them the stage was over
};
/// After every frame, from the start of the estimate on, with which they changed or the stage
/// ended. Empty of a recording without guide.
std::vector<KeptViews> keptViews(const OperatedSession& operated,
                                 GuideStage stage = GuideStage::kCamera);

/// From when on a recording calibrates its rig. The cameras: of a guided recording the frames that
/// the guide had kept by then, of another every frame so far; the IMU: all frames
/// of its own part, under the cameras that the first part gave, with the options' board
/// (guide_shape) throughout. Right is what stays right for `in_a_row` calibrations.
OperatedConvergence convergenceOf(const OperatedSession& operated, const OperatedOptions& made,
                                  const Calibration& truth, const ConvergenceOptions& options = {});

}  // namespace plumbline
