// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/simulate/rig.h"
#include "evaluate/simulation/operated_session.h"

namespace plumbline {

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
