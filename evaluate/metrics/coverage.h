// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// Corners and errors of one camera, gathered over a grid of image regions.
struct RegionalErrors {
  static constexpr int kColumns = 8;
  static constexpr int kRows = 6;
  /// Corners used in each region (row 0 is the top of the image).
  Eigen::Matrix<int, kRows, kColumns> count = Eigen::Matrix<int, kRows, kColumns>::Zero();
  /// Norm of the component-wise median error of each region [px]: what the model leaves there, with
  /// noise and outliers taken out.
  Eigen::Matrix<double, kRows, kColumns> typical_error_px =
      Eigen::Matrix<double, kRows, kColumns>::Zero();

  /// Share of regions with at least `least` corners.
  double coverage(int least = 1) const;
  struct Worst {
    double error_px = 0;
    int row = 0;
    int column = 0;
  };
  /// The region with the largest typical error among those with at least `least` corners; error 0
  /// if there is none.
  Worst worst(int least) const;
};

/// Bins the used corners of a camera. Corners outside the resolution are ignored.
RegionalErrors regionalErrors(const std::vector<CornerResidual>& residuals, int camera,
                              const Resolution& resolution);

/// Angle [rad] between camera 0's optical axis and the target's normal, for each pose; 0 is
/// frontal.
std::vector<double> viewTilts(const std::vector<Transform>& T_FC0);

/// What a sensor's stamps (ascending) say of its intervals. An interval above 1.5 times the median
/// is a gap, in which round(interval / median) - 1 samples are missing (one at least). All zero
/// but the count for fewer than two stamps.
SampleIntervals sampleIntervals(const std::string& sensor, const std::vector<TimeNs>& stamps);

/// Fills in sample_intervals and shown_intervals: every camera's views, with corners or without,
/// and the IMU's samples. Of long streams the shortest and the longest interval of each of 400
/// equal runs are shown, so that no gap is lost.
void addSampleIntervals(const Session& session, CalibrationRecord& record);

/// What the corners themselves say of the target's layout, whatever its size and their poses.
struct TargetLayout {
  /// Gap between neighbouring tags over their size: median over cross ratios of the four corners in
  /// line along two tags, large ones counting more. Empty without neighbouring tags.
  std::optional<double> spacing;
  int pairs_above = 0;     ///< tags seen together with the one that the grid puts above them
  int pairs_in_line = 0;   ///< of them, those whose edges stand in line: few where tagCols is wrong
  int pairs_beside = 0;    ///< tags seen together with the next one in their row
  int beside_in_line = 0;  ///< of them, those whose edges stand in line
  int tags = 0;            ///< tags seen with bottom-left, bottom-right and top-left corner
  int mirrored = 0;        ///< of them, those whose corners run clockwise, as from the board's back
  int largest_tag = -1;    ///< of all ids seen; -1 without any
};

/// From about 100 views of each camera, evenly in time. Cross ratios are taken in pixels where
/// `cameras` is empty (a lens' distortion then changes them by some per cent), otherwise after
/// the distortion of cameras[i] is taken from the corners of session.cameras[i]. The largest tag is
/// that of all views.
TargetLayout shownLayout(const Session& session, const std::vector<CameraCalibration>& cameras);

/// The same from the corners that a stage used, in its cameras.
TargetLayout shownLayout(const std::vector<CornerResidual>& residuals,
                         const std::vector<CameraCalibration>& cameras, const AprilGrid& target);

}  // namespace plumbline
