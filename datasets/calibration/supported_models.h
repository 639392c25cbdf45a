// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// Whether cameras of this kind can be calibrated: pinhole with radtan or equidistant distortion.
bool isSupportedModel(ProjectionModel projection, DistortionModel distortion);

/// "omni-radtan is not supported yet; expected pinhole-radtan or pinhole-equidistant; ...": the
/// text with which every reader and option refuses another model.
std::string unsupportedModelText(const std::string& projection, const std::string& distortion);

}  // namespace plumbline
