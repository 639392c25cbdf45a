// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/transform.h"

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

}  // namespace plumbline
