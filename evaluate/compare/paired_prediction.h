// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/results.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// Per camera, over the views that both results of the same session used: mean of
///   d_v = mean |e|^2 under `other` - mean |e|^2 under `first`   [px^2]
/// and its standard error. Pairing takes out what makes a view hard for both; neighbouring views
/// are alike, so the error comes from means of blocks of 10 consecutive views (of single views
/// where there are fewer than 5 blocks). Cameras without two common views are left out.
std::vector<PairedPrediction> pairedPredictions(const CameraStageResult& first,
                                                const CameraStageResult& other,
                                                const std::string& label);

}  // namespace plumbline
