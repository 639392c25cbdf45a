// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "calibrator/base/april_grid.h"

namespace plumbline {

/// The family tag36h11 as Kalibr prints it: 6 x 6 payload cells inside a black border of
/// `border_bits` cells (Kalibr prints 2, AprilTag's own sheets 1). Any two payloads, in any
/// rotation, differ in at least 11 of the 36 cells.
inline constexpr int kPayloadCells = 6;  ///< cells along an edge of the payload
inline constexpr int kFamilySize = 587;  ///< ids 0 ... 586
inline constexpr int kKalibrBorderBits = 2;

// Sizes of the grids that are printed and read. Kalibr's two traps: tagSize is in metres, and
// tagSpacing is no length but a ratio of it.
inline constexpr double kLargestTag_m = 5;       ///< above it the size is in another unit
inline constexpr double kSmallestSpacing = 0.1;  ///< Kalibr's squares need room; below: metres
inline constexpr double kLargestSpacing = 3;

/// Cells along the edge of a tag, border included.
constexpr int tagCells(int border_bits) { return kPayloadCells + 2 * border_bits; }

/// The white cells of a tag's payload: bit `6 * row + col` is set where the cell is white; col runs
/// right, row up, (0, 0) is the payload's bottom-left cell (the axes of AprilGrid's frame F).
/// 0 <= tag_id < kFamilySize.
std::uint64_t tagPayload(int tag_id);

/// Whether a cell of a tag is black. (col, row) = (0, 0) is the cell at the tag's corner 0
/// (bottom-left of the border), col along x of F, row along y; 0 <= col, row <
/// tagCells(border_bits).
bool cellIsBlack(int tag_id, int col, int row, int border_bits = kKalibrBorderBits);

/// Whether a point of the target's plane (frame F, [m]) is printed black: the tags, and the squares
/// of edge spacing * tag_size that Kalibr prints at all four corners of every tag, also outside the
/// outer tags. Everything else, to any distance, is white paper. grid.tagCount() <= kFamilySize.
bool gridIsBlack(const AprilGrid& grid, const Eigen::Vector2d& p_F,
                 int border_bits = kKalibrBorderBits);

}  // namespace plumbline
