// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibrator/base/time.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {

/// A CSV file read row by row where it lies in memory. Lines that start with '#' and empty lines
/// are skipped; a first line that starts with a letter is a header too. CRLF and a byte-order mark
/// are accepted. Every fault is an InputError with the file and line.
class CsvTable {
 public:
  enum class NoRows { kRefuse, kAccept };  ///< what a header without rows is; no header is a fault

  /// Throws InputError where the file is missing, empty, or has no rows. `layout` names the
  /// columns, for messages.
  CsvTable(const std::string& path, const std::string& layout, NoRows no_rows = NoRows::kRefuse);

  /// The header's names, trimmed and without '#'; empty where there is no header.
  const std::vector<std::string>& header() const { return header_; }
  const std::string& path() const { return path_; }

  /// Moves to the next row; false at the end.
  bool next();
  int line() const { return line_; }  ///< of the current row, from 1

  // The fields of the current row, in order. Each throws InputError where the field is missing or
  // not what is asked for; `name` is the column's, for messages.
  TimeNs stamp();                   ///< a positive integer [ns]
  int integer(const char* name);    ///< an integer
  double number(const char* name);  ///< a finite number, rounded correctly
  std::string_view word(const char* name);
  bool moreFields() const { return field_ != nullptr; }
  /// Throws unless all fields of the row have been taken.
  void endRow();

  /// Whether the current row is the last and has no newline.
  bool truncatedHere() const;

  /// An InputError at the current row.
  InputError fault(const Complaint& complaint) const { return badInput(path_, line_, complaint); }

 private:
  std::string_view field(const char* name);
  /// Moves behind the field if it ends at `stop`.
  bool takeUpTo(const char* stop);
  void readHeader();
  [[noreturn]] void failField(const char* name, std::string_view text, const char* expected) const;

  std::string path_;
  std::string layout_;
  MappedFile file_;
  std::vector<std::string> header_;
  const char* at_;     // start of what follows the current row
  const char* end_;    // of the file
  const char* field_;  // next field of the current row; nullptr: none left
  const char* row_end_;
  int line_ = 0;
  const char* stamp_text_ = nullptr;  // of the previous row, whose value is stamp_
  std::size_t stamp_size_ = 0;
  TimeNs stamp_ = 0;
  int decimals_ = 0;  // of the number read last
};

}  // namespace plumbline
