// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// Sets of tags that agree with each other on the grid, largest first (then by their first id): in
/// a set, each tag and some other at most two tags away predict each other's corners, through the
/// homography of their own four, to a fraction of a tag. Lone tags are sets of one. Mirrored
/// squares are in none, and no id is in a set twice. Ascending in id.
std::vector<std::vector<TagImage>> consistentSets(const AprilGrid& grid,
                                                  const std::vector<TagImage>& tags);

/// Gap over tag size as the image shows it: of four points in line, the two edges of a tag and of
/// its neighbour along a row or column, the cross ratio does not change under perspective and gives
/// the gap. Median over all such pairs, empty if there is none.
std::optional<double> apparentSpacing(const AprilGrid& grid, const std::vector<TagImage>& tags);

}  // namespace plumbline
