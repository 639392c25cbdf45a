// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/kalibr/results_lines.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"

namespace plumbline {
namespace {

constexpr const char* kAgain = "copy the file again, or calibrate again";

bool isBlank(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r'; }

}  // namespace

ResultsLines::ResultsLines(std::string path, std::string_view text) : path_(std::move(path)) {
  TextLines lines(text);
  while (lines.next()) lines_.push_back(lines.text());
}

std::string_view ResultsLines::line() const {
  return index_ >= 0 && !atEnd() ? lines_[index_] : std::string_view();
}

bool ResultsLines::next() {
  if (atEnd()) return false;
  ++index_;
  column_ = 0;
  return !atEnd();
}

bool ResultsLines::skipTo(std::string_view prefix) {
  while (next()) {
    if (startsWith(prefix)) return true;
  }
  return false;
}

bool ResultsLines::startsWith(std::string_view prefix) const {
  return line().substr(0, prefix.size()) == prefix;
}

bool ResultsLines::contains(std::string_view part) const {
  return line().find(part) != std::string_view::npos;
}

bool ResultsLines::sawLine(std::string_view prefix) const {
  const auto end = lines_.begin() + std::min<std::ptrdiff_t>(index_ + 1, std::ssize(lines_));
  return std::any_of(lines_.begin(), end,
                     [&](std::string_view l) { return l.substr(0, prefix.size()) == prefix; });
}

std::string ResultsLines::cameraName() const {
  for (std::size_t at = line().find("cam"); at != std::string_view::npos;
       at = line().find("cam", at + 1)) {
    std::size_t end = at + 3;
    while (end < line().size() && std::isdigit(static_cast<unsigned char>(line()[end])) != 0) ++end;
    // Without a number it is part of a word, such as "camera".
    if (end > at + 3) return std::string(line().substr(at, end - at));
  }
  return {};
}

std::string ResultsLines::between(char open, char close) const {
  const std::size_t from = line().find(open);
  const std::size_t to = line().rfind(close);
  if (from == std::string_view::npos || to == std::string_view::npos || to < from) return {};
  return std::string(line().substr(from + 1, to - from - 1));
}

double ResultsLines::number(std::string_view text) const {
  const auto value = parseNumber(text);
  if (!value) throw fault(fmt::format("'{}' is not a number", text), "a number");
  if (std::isfinite(*value)) return *value;
  throw badInput(
      path_, index_ + 1,
      {InputFault::kNotFinite, fmt::format("a result is {}: the optimisation diverged", text),
       "finite numbers", "nothing in this file can be used: calibrate again"});
}

double ResultsLines::numberAfter(std::string_view key, std::string_view other) const {
  const bool first = other.empty() || line().find(key) != std::string_view::npos;
  // "median " also begins "median: " where the colon follows.
  const std::string_view used = first ? key : other;
  const std::size_t at = line().find(used);
  if (at == std::string_view::npos) {
    throw fault(fmt::format("'{}' is missing", used), "a line as Kalibr writes it",
                InputFault::kMissingKey);
  }
  std::string_view rest = trimmedText(line().substr(at + used.size()));
  // Also at the underscore of "T_1_0" and at the bracket of a unit.
  const std::size_t end = std::min(rest.find_first_of(" ,_[\t"), rest.size());
  return number(rest.substr(0, end));
}

// Over as many lines as it takes: a matrix has its rows in brackets of their own, and numpy, which
// prints these, breaks long arrays.
std::vector<double> ResultsLines::bracket(std::size_t count) {
  std::vector<double> numbers;
  int depth = 0;
  bool open = false;
  while (!atEnd()) {
    for (; column_ < line().size(); ++column_) {
      const char c = line()[column_];
      if (c == '[') open = ++depth > 0;
      if (c == ']' && depth > 0 && --depth == 0) {
        ++column_;
        if (count == 0 || numbers.size() == count) return numbers;
        throw fault(fmt::format("{} numbers in brackets", numbers.size()), std::to_string(count));
      }
      if (!open || isBlank(c) || c == '[' || c == ']') continue;
      std::size_t end = column_;
      while (end < line().size() && !isBlank(line()[end]) && line()[end] != ']') ++end;
      numbers.push_back(number(line().substr(column_, end - column_)));
      column_ = end - 1;
    }
    if (!open) break;
    next();
  }
  if (open) throw ended("the end of a list in brackets");
  throw fault("no list in brackets", "[ numbers ]");
}

BadInput ResultsLines::fault(const std::string& what, const std::string& expected,
                             InputFault code) const {
  const int shown = std::clamp(index_ + 1, 1, std::max<int>(1, static_cast<int>(lines_.size())));
  return badInput(path_, shown, {code, what, expected, kAgain});
}

BadInput ResultsLines::ended(const std::string& missing) const {
  return badInput(path_, static_cast<int>(lines_.size()),
                  {InputFault::kTruncated, "the file ends before " + missing,
                   "the whole results text of Kalibr", kAgain});
}

}  // namespace plumbline
