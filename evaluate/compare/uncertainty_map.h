// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/information/projection_uncertainty.h"
#include "evaluate/compare/image_grid.h"

namespace plumbline {

/// worstDirectionStd() [px] of every grid pixel, for points `range_m` away; NaN where undefined.
std::vector<double> uncertaintyMap(const Intrinsics& camera, const ProjectionCovariance& covariance,
                                   double range_m, const ImageGrid& grid = {});

/// Weights of the fit of a projection difference, mrcal's choice: (1 / (s_A s_B))^2 at each pixel,
/// s the two calibrations' standard deviations.
std::vector<double> differenceWeights(const std::vector<double>& std_A,
                                      const std::vector<double>& std_B);

}  // namespace plumbline
