// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

namespace plumbline {

/// The text without blanks, tabs and carriage returns at its ends.
inline std::string_view trimmedText(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

/// The lines of a text in memory, trimmed, counted from 1. A byte-order mark is skipped.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : rest_(text) {
    if (rest_.substr(0, 3) == "\xEF\xBB\xBF") rest_.remove_prefix(3);
  }

  /// Moves to the next line; false at the end.
  bool next() {
    if (rest_.empty()) return false;
    const void* found = std::memchr(rest_.data(), '\n', rest_.size());
    ended_ = found != nullptr;
    const std::size_t size =
        ended_ ? static_cast<std::size_t>(static_cast<const char*>(found) - rest_.data())
               : rest_.size();
    line_ = trimmedText(rest_.substr(0, size));
    rest_.remove_prefix(ended_ ? size + 1 : size);
    ++number_;
    return true;
  }
  std::string_view text() const { return line_; }
  int number() const { return number_; }
  bool ended() const { return ended_; }  ///< by a newline; false: the file stops in this line

 private:
  std::string_view rest_;
  std::string_view line_;
  int number_ = 0;
  bool ended_ = true;
};

/// The cells between commas, trimmed, without quotation marks around them.
inline std::vector<std::string_view> csvCells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t from = 0; from <= line.size();) {
    const bool quoted = from < line.size() && line[from] == '"';
    const std::size_t closing = quoted ? line.find('"', from + 1) : std::string_view::npos;
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

}  // namespace plumbline
