// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

// The beginning of a cell for a message, without bytes that a terminal would act upon.
std::string quotable(std::string_view text) {
  std::string out(text.substr(0, 40));
  std::ranges::replace_if(
      out, [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

std::size_t decimalsOf(std::string_view number) {
  const std::size_t point = number.find('.');
  if (point == std::string_view::npos) return 0;
  const auto* const first = number.begin() + point + 1;
  return static_cast<std::size_t>(std::find_if_not(first, number.end(), isDigit) - first);
}

// A comma may end a row.
std::string_view lastCell(std::string_view row) {
  if (!row.empty() && row.back() == ',') row = trimmedText(row.substr(0, row.size() - 1));
  return row.substr(row.find_last_of(", \t") + 1);
}

/// nan begins a row of numbers, other letters a line of names.
bool beginsWithName(std::string_view line) {
  return std::isalpha(static_cast<unsigned char>(line[0])) != 0 && line.substr(0, 3) != "nan";
}

std::string columnName(const char* name) { return "column '" + std::string(name) + "'"; }

}  // namespace

std::string_view trimmedText(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

bool TextLines::next() {
  if (rest_.empty()) return false;
  const std::size_t stop = rest_.find('\n');
  ended_ = stop != std::string_view::npos;
  line_ = trimmedText(rest_.substr(0, stop));
  rest_.remove_prefix(ended_ ? stop + 1 : rest_.size());
  ++number_;
  return true;
}

Cells csvCells(std::string_view line) {
  Cells cells;
  for (std::size_t from = 0; from <= line.size();) {
    // A comma between quotation marks separates nothing.
    const bool quoted = from < line.size() && line[from] == '"';
    const std::size_t closing = quoted ? line.find('"', from + 1) : std::string_view::npos;
    // A quotation mark that nothing closes is a letter like others.
    const std::size_t search = closing == std::string_view::npos ? from : closing;
    const std::size_t comma = std::min(line.find(',', search), line.size());
    std::string_view cell = trimmedText(line.substr(from, comma - from));
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
      cell = cell.substr(1, cell.size() - 2);
    }
    cells.push_back(cell);
    from = comma + 1;
  }
  return cells;
}

const std::vector<std::string_view>& TextTable::readHeader(NoRows no_rows) {
  // Comments, and one line of names where no comment came before; the first row is left to
  // nextRow().
  for (TextLines before = lines_; lines_.next(); before = lines_) {
    const std::string_view text = lines_.text();
    if (text.empty()) continue;
    const bool comment = text.front() == '#';
    if (!comment && !(header_.empty() && beginsWithName(text))) {
      lines_ = before;
      return header_;
    }
    header_.push_back(trimmedText(comment ? text.substr(1) : text));
  }
  if (no_rows == NoRows::kAccept && !header_.empty()) return header_;
  throw badInput(
      path_, {InputFault::kEmpty, text_.empty() ? "is empty" : "has no rows", "rows of " + layout_,
              "was the recording or the copy interrupted? Export the file again"});
}

bool TextTable::nextLine() {
  if (!lines_.next()) return false;
  at_ = lines_.text().data();
  end_ = at_ + lines_.text().size();
  comma_ = false;
  return true;
}

bool TextTable::nextRow() {
  while (nextLine()) {
    if (at_ != end_ && *at_ != '#') return true;
  }
  return false;
}

// Past what separates two cells: blanks, with at most one comma among them.
void TextTable::takeSeparator(const char* stop) {
  at_ = std::find_if_not(stop, end_, isBlank);
  if (at_ == end_ || *at_ != ',') return;
  comma_ = true;
  at_ = std::find_if_not(at_ + 1, end_, isBlank);
}

std::optional<double> TextTable::takeNumber() {
  const auto [value, stop] = scanNumber(at_, end_);
  // A number ends where its cell does: "1.5px" is none.
  if (stop == nullptr || (stop != end_ && *stop != ',' && !isBlank(*stop))) return std::nullopt;
  number_ = {at_, static_cast<std::size_t>(stop - at_)};
  takeSeparator(stop);
  return value;
}

std::string_view TextTable::word(const char* name) {
  if (!moreCells()) failMissing(name);
  const char* const stop = std::find(at_, end_, ',');
  const std::string_view text = trimmedText({at_, static_cast<std::size_t>(stop - at_)});
  takeSeparator(stop);
  return text;
}

TimeNs TextTable::stamp() {
  // Rows of one frame: the text of the row above once more.
  const std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
  const std::size_t size = stamp_text_.size();
  if (size > 0 && rest.size() > size && rest[size] == ',' && rest.substr(0, size) == stamp_text_) {
    takeSeparator(at_ + size);
    return stamp_;
  }
  const char* const cell = at_;
  const std::string_view text = word("timestamp [ns]");
  TimeNs value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && stop == text.data() + text.size() && value >= 0) {
    stamp_text_ = text;
    return stamp_ = value;
  }
  if (text.find(';') != std::string_view::npos) {
    throw fault({InputFault::kBadColumns, "the row '" + quotable(text) + "' has no comma",
                 "cells separated by commas", "replace the semicolons by commas"});
  }
  // Told apart from other faults, as seconds with decimals are what most tools write.
  if (text.find('.') != std::string_view::npos) {
    constexpr double kMostSeconds = 1e11;  // the year 5138; of nanoseconds two minutes
    const bool seconds = parseNumber(text).value_or(0) < kMostSeconds;
    throw fault({InputFault::kWrongUnit, "the stamp '" + quotable(text) + "' has a decimal point",
                 "an integer number of nanoseconds",
                 seconds ? "stamps in seconds must be multiplied by 1e9 and written as integers"
                         : "write all digits, without a point or an exponent"});
  }
  failCell(cell, "timestamp [ns]", "an integer number of nanoseconds, not negative");
}

int TextTable::integer(const char* name) {
  if (!moreCells()) failMissing(name);
  int value = 0;
  const auto [stop, error] = std::from_chars(at_, end_, value);
  if (error != std::errc() || (stop != end_ && *stop != ',' && !isBlank(*stop))) {
    failCell(at_, name, "an integer");
  }
  takeSeparator(stop);
  return value;
}

double TextTable::number(const char* name) {
  if (!moreCells()) failMissing(name);
  const char* const cell = at_;
  const std::optional<double> value = takeNumber();
  if (!value) failCell(cell, name, "a number");
  if (!std::isfinite(*value)) failCell(cell, name, "a finite number", InputFault::kNotFinite);
  if (!moreCells()) checkDecimals();
  return *value;
}

std::size_t TextTable::fixedDecimals() const {
  constexpr int kTelling = 10;  // rows: of fewer, shortest digits may all be as many by chance
  std::size_t decimals = 0;
  int rows = 0;
  TextLines above(text_);
  while (above.next() && above.number() < line()) {
    const std::string_view text = above.text();
    if (text.empty() || text.front() == '#' || beginsWithName(text)) continue;
    const std::size_t own = decimalsOf(lastCell(text));
    if (rows > 0 && own != decimals) return 0;
    decimals = own;
    ++rows;
  }
  return rows < kTelling ? 0 : decimals;
}

// A last line without its newline may have lost digits of its last number: that would be a wrong
// value rather than a missing one. Programs that write the shortest digits end in few by chance.
void TextTable::checkDecimals() const {
  // What was cut among its decimals has no exponent, and is not nan or inf.
  if (!truncatedHere() || number_.find_first_of("eEnN") != std::string_view::npos) return;
  if (decimalsOf(number_) >= fixedDecimals()) return;
  throw fault({InputFault::kTruncated,
               "the last line ends without a newline and '" + std::string(number_) +
                   "' has fewer decimals than that column in all rows before, so it may be cut",
               "a whole last line", "copy the file again, or end the line if it is complete"});
}

NumberRow TextTable::numbers() {
  NumberRow row;
  while (moreCells()) {
    if (row.columns == NumberRow::kMostColumns) {
      throw fault({InputFault::kBadColumns, "more than 64 columns", "a table of numbers",
                   "is this the right file?"});
    }
    const std::optional<double> value = takeNumber();
    if (!value) {
      const std::string_view cell(at_, static_cast<std::size_t>(end_ - at_));
      throw fault({InputFault::kBadNumber,
                   fmt::format("column {} is '{}'", row.columns + 1,
                               quotable(cell.substr(0, cell.find_first_of(", ")))),
                   "a number", rowCure()});
    }
    if (row.columns == 0) row.stamp = number_;
    row.values[static_cast<std::size_t>(row.columns++)] = *value;
  }
  row.commas = comma_;
  return row;
}

void TextTable::expectColumns(const NumberRow& row, int columns, const char* whose) const {
  if (row.columns == columns) return checkDecimals();
  throw fault({truncatedHere() ? InputFault::kTruncated : InputFault::kBadColumns,
               fmt::format("the row has {} columns", row.columns),
               fmt::format("{}, {}", columns, whose), rowCure()});
}

double TextTable::numberIn(const Cells& cells, std::size_t column) const {
  const std::string_view cell = column < cells.size() ? cells[column] : std::string_view();
  if (const auto value = parseNumber(cell)) return *value;
  throw fault(
      {column >= cells.size() && truncatedHere() ? InputFault::kTruncated : InputFault::kBadNumber,
       fmt::format("column {} is '{}'", column + 1, quotable(cell)), "a number", rowCure()});
}

void TextTable::endRow() const {
  if (!moreCells()) return;
  throw fault({InputFault::kBadColumns, "the row has more columns than expected",
               "a row of " + layout_, "repair or delete this line"});
}

const char* TextTable::rowCure() const {
  return truncatedHere() ? "the file is truncated: copy it again or delete this line"
                         : "repair or delete this line";
}

void TextTable::failCell(const char* cell, const char* name, const char* expected,
                         InputFault code) const {
  const std::string_view text(cell, static_cast<std::size_t>(std::find(cell, end_, ',') - cell));
  throw fault(
      {code, columnName(name) + " is '" + quotable(trimmedText(text)) + "'", expected, rowCure()});
}

void TextTable::failMissing(const char* name) const {
  throw fault({truncatedHere() ? InputFault::kTruncated : InputFault::kBadColumns,
               (truncatedHere() ? "the last line is cut: " : "") + columnName(name) + " is missing",
               "a row of " + layout_, rowCure()});
}

}  // namespace plumbline
