// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"

namespace plumbline {

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
