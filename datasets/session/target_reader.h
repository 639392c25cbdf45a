// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/april_grid.h"

namespace plumbline {

/// Reads Kalibr's target.yaml (target_type: aprilgrid; tagRows, tagCols, tagSize [m], tagSpacing as
/// a ratio of tagSize). Throws InputError for checkerboards and circle grids, which are not
/// supported yet, and for sizes that cannot be metres or ratios.
AprilGrid readTarget(const std::string& path);

}  // namespace plumbline
