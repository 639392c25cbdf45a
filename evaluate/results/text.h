// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/transform.h"

namespace plumbline {

/// What a summary or a table is written into; fmt::to_string() gives the text.
using Text = fmt::memory_buffer;

/// Appends; format and arguments as fmt::format() has them. Not by fmt::format_to(), for which
/// fmt's writers of numbers are compiled again in every unit: those of fmt::format() are in its
/// library.
template <class... Args>
void add(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  text.append(fmt::format(format, std::forward<Args>(args)...));
}

/// Width of a column of names: two blanks behind the longest, at least `least`.
template <class Rows, class Name>
std::size_t nameWidth(const Rows& rows, std::size_t least, const Name& name) {
  for (const auto& row : rows) least = std::max(least, std::string(name(row)).size() + 2);
  return least;
}

/// What stands between blanks and line ends.
inline std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// A unit as a person reads it, and what one of the record's is in it: lengths in millimetres,
/// angles in degrees, times in milliseconds; no word for numbers without a unit.
struct ShownUnit {
  const char* unit = "";
  double factor = 1;
};
inline ShownUnit shownUnit(const std::string& unit) {
  if (unit == "rad") return {"deg", kDegrees};
  if (unit == "m") return {"mm", 1e3};
  if (unit == "s") return {"ms", 1e3};
  return {unit == "px" ? "px" : "", 1};
}

/// So many significant digits, and no exponent of large values: "12.3", "1234" for 3.
inline std::string significant(double value, int digits) {
  // From 99.5 on two digits would round to 1e+02.
  const bool large = std::abs(value) >= std::pow(10, digits) - 0.5;
  return large ? fmt::format("{:.0f}", value) : fmt::format("{:.{}g}", value, digits);
}

/// The same of a magnitude that is shown to people: "0" below a millionth of its unit, which is
/// rounding, and with a power of ten from a million on.
inline std::string significantOrZero(double value, int digits) {
  if (std::abs(value) < 1e-6) return "0";
  return std::abs(value) >= 1e6 ? fmt::format("{:.1e}", value) : significant(value, digits);
}

/// A cell of a CSV file: quoted where a comma, a quote or a line end would break the row.
inline std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// Every `from`, which is not empty, replaced.
inline std::string replaceAll(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

}  // namespace plumbline
