// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

struct ParameterName {
  std::string name;
  std::string unit;  ///< "px" or "-"
};

/// Names of Intrinsics::stacked(), in its order, as Kalibr's documents call them: xi, alpha, beta
/// before fu fv pu pv, then k1 ... p2, k1 ... k4, or w.
std::vector<ParameterName> intrinsicParameters(ProjectionModel projection,
                                               DistortionModel distortion);

}  // namespace plumbline
