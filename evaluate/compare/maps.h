// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "evaluate/compare/projection_difference.h"
#include "evaluate/metrics/calibration/uncertainty_maps.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// Weights of the fit of a projection difference, mrcal's choice: (1 / (s_A s_B))^2 at each pixel,
/// s the two calibrations' standard deviations.
std::vector<double> differenceWeights(const std::vector<double>& std_A,
                                      const std::vector<double>& std_B);

struct MapOptions {
  std::vector<double> ranges_m{std::numeric_limits<double>::infinity(), 1.0};
  ImageGrid grid;
  double focus_radius_px = 0;  ///< see DifferenceOptions; above 0 fits are not weighted
  DifferenceFit fit = DifferenceFit::kSquares;

  /// Throws InputError for values out of range.
  void check() const;
};

/// Difference maps "b - a" of every camera and range that both have with images of one size. The
/// fit is weighted by `uncertainties` where both calibrations have a map there.
std::vector<ImageMap> differenceMaps(const ComparedCalibration& a, const ComparedCalibration& b,
                                     const std::vector<ImageMap>& uncertainties,
                                     const MapOptions& options);

}  // namespace plumbline
