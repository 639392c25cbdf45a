// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string_view>

#include "datasets/files/text_lines.h"
#include "datasets/trajectory/trajectory_builder.h"

namespace plumbline {

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
