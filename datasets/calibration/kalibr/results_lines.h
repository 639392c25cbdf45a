// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/files/bad_input.h"

namespace plumbline {

/// Walks the lines of a results text; lists in brackets may go on over several lines. Numbers that
/// are not finite are an InputError at their line.
class ResultsLines {
 public:
  ResultsLines(std::string path, std::string_view text);

  /// Moves to the next line, trimmed, from its first character; false at the end.
  bool next();
  bool atEnd() const { return index_ >= static_cast<int>(lines_.size()); }
  /// Moves on to the next line that starts with `prefix`; false at the end.
  bool skipTo(std::string_view prefix);

  bool startsWith(std::string_view prefix) const;
  bool contains(std::string_view part) const;
  /// Whether a line that starts with `prefix` was passed.
  bool sawLine(std::string_view prefix) const;

  /// The first "camN" in the line; empty if there is none.
  std::string cameraName() const;
  std::string between(char open, char close) const;
  /// The number that follows `key` (or `other`, where that is not in the line).
  double numberAfter(std::string_view key, std::string_view other = {}) const;
  /// The numbers of the next [...] from here on, nested or not, `count` of them if that is not 0.
  std::vector<double> bracket(std::size_t count = 0);

  BadInput fault(const std::string& what, const std::string& expected,
                 InputFault code = InputFault::kBadNumber) const;
  /// The file ends before something that it should hold.
  BadInput ended(const std::string& missing) const;

 private:
  std::string_view line() const;
  double number(std::string_view text) const;

  std::string path_;
  std::vector<std::string_view> lines_;
  int index_ = -1;
  std::size_t column_ = 0;  // where bracket() goes on
};

}  // namespace plumbline
