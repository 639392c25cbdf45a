// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/trajectory/table_row.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "datasets/files/number_scanner.h"

namespace plumbline {
namespace {

// The cell at `at`, for a message, without bytes that a terminal would act upon.
std::string quotable(const char* at, const char* end) {
  std::string cell(at, std::min(std::find_if(at, end, [](char c) { return c == ',' || c == ' '; }),
                                at + std::min<std::ptrdiff_t>(end - at, 40)));
  std::replace_if(
      cell.begin(), cell.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return cell;
}

const char* skipBlanks(const char* at, const char* end) {
  while (at != end && (*at == ' ' || *at == '\t')) ++at;
  return at;
}

std::string cureOf(const TextLines& line) {
  return line.ended() ? "repair or delete this line"
                      : "the file is truncated: copy it again or delete this line";
}

// Past what separates two cells. nullptr: something else stands here.
const char* skipSeparator(const char* at, const char* end, TableRow& row) {
  const char* next = skipBlanks(at, end);
  if (next != end && *next == ',') {
    row.commas = true;
    return skipBlanks(next + 1, end);
  }
  return next == at && at != end ? nullptr : next;
}

}  // namespace

TableRow parseTableRow(const TrajectorySource& source, const TextLines& line) {
  TableRow row;
  const char* at = line.text().data();
  const char* const end = at + line.text().size();
  while (at != end) {
    if (row.columns == TableRow::kMostColumns) {
      throw source.fault(line.number(),
                         {"more than 64 columns", "a table of poses", "is this the right file?"});
    }
    const ScannedNumber number = scanNumber(at, end);
    const char* const next =
        number.next == nullptr ? nullptr : skipSeparator(number.next, end, row);
    if (next == nullptr) {
      throw source.fault(line.number(),
                         {fmt::format("column {} is '{}'", row.columns + 1, quotable(at, end)),
                          "a number", cureOf(line)});
    }
    if (row.columns == 0) row.stamp = {at, static_cast<std::size_t>(number.next - at)};
    row.values[static_cast<std::size_t>(row.columns++)] = number.value;
    at = next;
  }
  return row;
}

void checkColumns(const TrajectorySource& source, const TextLines& line, const TableRow& row,
                  int columns) {
  if (row.columns == columns) return;
  throw source.fault(line.number(),
                     {fmt::format("the row has {} columns", row.columns),
                      fmt::format("{}, as in the first row", columns), cureOf(line)});
}

}  // namespace plumbline
