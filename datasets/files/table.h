// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrator/base/time.h"
#include "datasets/files/bad_input.h"

namespace plumbline {

/// The text without blanks, tabs and carriage returns at its ends.
std::string_view trimmedText(std::string_view text);

/// The lines of a text in memory, trimmed, counted from 1. A byte-order mark is skipped.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : rest_(text) {
    if (rest_.substr(0, 3) == "\xEF\xBB\xBF") rest_.remove_prefix(3);
  }

  /// Moves to the next line; false at the end.
  bool next();
  std::string_view text() const { return line_; }
  int number() const { return number_; }
  bool ended() const { return ended_; }  ///< by a newline; false: the file stops in this line

 private:
  std::string_view rest_;
  std::string_view line_;
  int number_ = 0;
  bool ended_ = true;
};

using Cells = std::vector<std::string_view>;

/// The cells between commas, trimmed, without quotation marks around them.
Cells csvCells(std::string_view line);

/// All cells of a row as numbers.
struct NumberRow {
  static constexpr int kMostColumns = 64;
  std::array<double, kMostColumns> values;  // NOLINT: only `columns` of them are set
  int columns = 0;
  std::string_view stamp;  ///< text of the first
  bool commas = false;     ///< separate the cells; otherwise blanks
};

/// A text table read row by row where it lies in memory: the mechanism of all tabular files here.
/// Cells are separated by commas, numbers also by blanks; a comma may end a row. CRLF and a
/// byte-order mark are accepted. Every fault is an InputError with the file and line.
class TextTable {
 public:
  enum class NoRows { kRefuse, kAccept };  ///< what a header without rows is; no header is a fault

  /// `text` must outlive the table. `layout` names the columns of a row, for messages.
  TextTable(std::string path, std::string_view text, std::string layout = "")
      : path_(std::move(path)), layout_(std::move(layout)), text_(text), lines_(text) {}

  /// Moves before the first row. The lines before it: those that start with '#', without it, and a
  /// first line that starts with a letter. Throws InputError where no row follows.
  const std::vector<std::string_view>& readHeader(NoRows no_rows = NoRows::kRefuse);

  bool nextLine();  ///< any line; false at the end
  bool nextRow();   ///< the next line that is neither empty nor a comment; false at the end

  const std::string& path() const { return path_; }
  std::string_view row() const { return lines_.text(); }
  int line() const { return lines_.number(); }  ///< from 1
  /// Whether the current row is the last and has no newline.
  bool truncatedHere() const { return !lines_.ended(); }

  // The cells of the current row, in order. Each throws InputError where the cell is missing or not
  // what is asked for; `name` is the column's, for messages.
  bool moreCells() const { return at_ != end_; }
  TimeNs stamp();                           ///< an integer [ns] that is not negative
  int integer(const char* name);            ///< an integer
  double number(const char* name);          ///< a finite number, rounded correctly
  std::string_view word(const char* name);  ///< up to the next comma
  NumberRow numbers();                      ///< all of them, with nan and inf
  /// Throws unless the row has so many columns, of which `whose` says why, and its last number is
  /// whole as far as can be told.
  void expectColumns(const NumberRow& row, int columns,
                     const char* whose = "as in the first row") const;
  /// Throws unless all cells of the row have been taken.
  void endRow() const;

  Cells cells() const { return csvCells(lines_.text()); }
  /// The cell of that column, from 0, as a number, with nan and inf.
  double numberIn(const Cells& cells, std::size_t column) const;

  /// An InputError at the current line.
  BadInput fault(const Complaint& complaint) const { return badInput(path_, line(), complaint); }
  /// What to do about a row that is no row: where the file stops in it, it was cut.
  const char* rowCure() const;

 private:
  void takeSeparator(const char* stop);
  std::optional<double> takeNumber();  ///< the current cell; nothing where it is no number
  [[noreturn]] void failCell(const char* cell, const char* name, const char* expected,
                             InputFault code = InputFault::kBadNumber) const;
  [[noreturn]] void failMissing(const char* name) const;
  void checkDecimals() const;
  /// How many decimals the last number of every row before this one has; 0 where they differ or the
  /// rows are too few to tell.
  std::size_t fixedDecimals() const;

  std::string path_;
  std::string layout_;
  std::string_view text_;
  TextLines lines_;
  std::vector<std::string_view> header_;
  const char* at_ = nullptr;  // next cell of the current row; end_: none left
  const char* end_ = nullptr;
  bool comma_ = false;           // between cells of the current row
  std::string_view number_;      // text of the last number
  std::string_view stamp_text_;  // of the previous row, whose value is stamp_
  TimeNs stamp_ = 0;
};

}  // namespace plumbline
