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
  int in_a_row = 3;       ///< calibrations within the bars, from the first of which it is right
  double first_s = 2;     ///< unguided, and for the IMU: calibrated first after so long ...
  double growth = 1.1;    ///< ... and then after so many times the time (or views) before
  double stride_s = 0.2;  ///< unguided, cameras are calibrated on frames so far apart

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
/// the guide had kept by then, of another every frame so far, `stride_s` apart; the IMU: all frames
/// of its own part, under the cameras that the first part gave, with the options' board
/// (guide_shape) throughout. Right is what stays right for `in_a_row` calibrations.
OperatedConvergence convergenceOf(const OperatedSession& operated, const OperatedOptions& made,
                                  const Calibration& truth, const ConvergenceOptions& options = {});

/// A recording, what it was made with, and on which rig.
struct Operation {
  const OperatedSession& operated;
  const OperatedOptions& made;
  const SimulatedRig& rig;
};

/// The stop of a stage held against the best one: of the camera stage that by projections
/// (ViewGuideOptions::stop_projection_px), of the camera-IMU stage that by points that the IMU
/// predicts (TrajectoryGuideOptions::stop_reprojection_px). A stopping rule does not know this
/// recording's noise: what it can meet is the expected error.
struct StopHindsight {
  double stopped_s = 0;               ///< the stage's stop, since it began
  double predicted_px = 0;            ///< by the guide, at its stop
  std::optional<double> expected_px;  ///< expectedProjectionPx() or expectedReprojectionPx() ...
  std::optional<double> drawn_px;     ///< ... drawnProjectionPx() or drawnReprojectionPx() ...
  int views = 0;                      ///< ... of the views at the stop
  /// First time, with the views kept then, from which the expected error is at most the bar; empty:
  /// not within the recording, continued.
  std::optional<double> best_s;
  std::optional<int> best_views;
  std::optional<double> predicted_at_best_px;
  /// Where there is none: until when it was looked for, and what is expected with the views kept
  /// then; empty: that is not known either.
  std::optional<double> searched_s, expected_at_end_px;
};

template <class V>
void fields(V& v, StopHindsight& s) {
  v("stopped_s", s.stopped_s, "s", "the guide's stop, since the stage began");
  v("predicted_px", s.predicted_px, "px", "error that the guide predicted at its stop");
  v("expected_px", s.expected_px, "px", "expected with its views, from the truth");
  v("drawn_px", s.drawn_px, "px", "RMS over draws of the noise with its views");
  v("views", s.views, "1", "of them");
  v("best_s", s.best_s, "s", "first time with an expected error within the bar");
  v("best_views", s.best_views, "1", "views kept then");
  v("predicted_at_best_px", s.predicted_at_best_px, "px", "what the guide predicted then");
  v("searched_s", s.searched_s, "s", "without such a time: until when it was looked for");
  v("expected_at_end_px", s.expected_at_end_px, "px", "expected with the views kept then");
}

/// Of both stages; empty: the stage did not end by a bar in pixels.
struct OperatedStops {
  std::optional<StopHindsight> cameras, camera_imu;
};

template <class V>
void fields(V& v, OperatedStops& s) {
  v("cameras", s.cameras, "by the projections");
  v("camera_imu", s.camera_imu, "by points that the IMU predicts");
}

struct HindsightOptions {
  int draws = 20;           ///< of the noise
  double beyond = 0.5;      ///< the recording continues to a stop at this share of the bar ...
  double beyond_times = 3;  ///< ... for at most so many times the stop's time
};

/// Expected projection error of a calibration on these frames, of the worst camera [px]: RMS over
/// the noise of the corners of trueProjectionErrorPx(), to first order,
///   E^2 = bias^2 + imageFitMeanSquare(covariance),
/// from the calibration on exact corners at the true poses: its error (0 unless the board is not
/// the true one) and its covariance under the true noise. Empty where there is no calibration.
std::optional<double> expectedProjectionPx(const Operation& of, const std::vector<int>& frames);

/// The same as an RMS over draws of the noise, each calibrated from a start at the truth. Of n
/// draws it is known to some 0.4 / sqrt(n). Empty where a draw gives no calibration.
std::optional<double> drawnProjectionPx(const Operation& of, const std::vector<int>& frames,
                                        int draws);

/// Expected error of points that the IMU predicts (ImuReprojection) with a camera-IMU calibration
/// on these frames, under the true cameras [px]: RMS over the noise of corners and IMU, to first
/// order,
///   E^2 = (d, e)^T M (d, e) + tr(M S),
/// from the calibration on exact measurements of the true motion: its error (d, e) (0 unless the
/// board is not the true one) and its covariance S under the true noise (covarianceUnder()). Empty
/// where there is no calibration.
std::optional<double> expectedReprojectionPx(const Operation& of, const std::vector<int>& frames);

/// The same as an RMS over draws of the noise of corners and IMU, without those that do not
/// converge. Of n draws it is known to some 0.4 / sqrt(n) or worse. Empty where a draw gives no
/// calibration.
std::optional<double> drawnReprojectionPx(const Operation& of, const std::vector<int>& frames,
                                          int draws);

/// Of a guided recording whose stage ended by its bar in pixels. Where its views are not enough it
/// is continued: made again, equal up to its stop, with a lower bar. The expected error falls with
/// the views: its crossing is bisected. Empty where the stage did not end so.
std::optional<StopHindsight> stopHindsight(const Operation& of, GuideStage stage,
                                           const HindsightOptions& options = {});

}  // namespace plumbline
