// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "datasets/files/text_lines.h"
#include "datasets/trajectory/formats.h"

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

/// The numbers of one line, separated by commas or blanks.
struct TableRow {
  static constexpr int kMostColumns = 64;
  std::array<double, kMostColumns> values;  // NOLINT: only `columns` of them are set
  int columns = 0;
  std::string_view stamp;  ///< text of the first
  bool commas = false;
};

/// Throws InputError where a cell is empty or no number.
TableRow parseTableRow(const TrajectorySource& source, const TextLines& line);

/// Throws InputError unless the row has `columns`; `layout` names them.
void checkColumns(const TrajectorySource& source, const TextLines& line, const TableRow& row,
                  int columns);

}  // namespace plumbline
