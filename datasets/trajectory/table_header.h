// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace plumbline {

/// What the header line of a table of poses states; columns count from 0.
struct TableHeader {
  std::optional<int> stamp_power;                ///< 10^power nanoseconds are the stamps' unit
  std::optional<int> position;                   ///< column of x; y and z follow
  std::optional<std::array<int, 4>> quaternion;  ///< columns of x, y, z, w
};

/// Reads "# timestamp(s) tx ty tz qx qy qz qw", "#timestamp [ns], p_RS_R_x [m], ..., q_RS_w [],
/// ..." and their kind: a name of time, then names separated by commas or blanks, units in
/// brackets. Nothing where the line is some other comment.
std::optional<TableHeader> parseTableHeader(std::string_view line);

}  // namespace plumbline
