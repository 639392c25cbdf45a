// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/april_grid.h"

namespace plumbline {

/// Reads Kalibr's target.yaml (target_type: aprilgrid; tagRows, tagCols, tagSize [m], tagSpacing as
/// a ratio of tagSize). Throws InputError for checkerboards and circle grids, which are not
/// supported yet, and for sizes that cannot be metres or ratios.
AprilGrid readTarget(const std::string& path);

inline constexpr const char* kTargetShapeFile = "target_shape.yaml";

/// kTargetShapeFile: the shape of a board, as `plumbline calibrate` leaves it and --target-shape
/// takes it. It names the grid that it belongs to (tagRows, tagCols, tagSize, tagSpacing), every
/// term in millimetres (kTargetTermNames), and their covariance where it is known.
std::string targetShapeText(const AprilGrid& board);

/// Reads it for a board. Throws InputError for a malformed file, terms that are missing, unknown or
/// above 50 mm, a covariance that is not positive semi-definite, or another grid than `grid`.
TargetShape readTargetShape(const std::string& path, const AprilGrid& grid);

}  // namespace plumbline
