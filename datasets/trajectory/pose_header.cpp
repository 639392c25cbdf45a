// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

struct Name {
  std::string text;  // lower case, without its unit
  std::string unit;  // within brackets
};

bool opens(char c) { return c == '[' || c == '('; }
bool closes(char c) { return c == ']' || c == ')'; }

// Names between separators; what stands in brackets is the unit of the name before it.
std::vector<Name> namesOf(std::string_view line, bool by_comma) {
  std::vector<Name> names;
  bool inside = false;
  bool begin = true;
  for (const char raw : line) {
    const char c = static_cast<char>(std::tolower(static_cast<unsigned char>(raw)));
    const bool blank = c == ' ' || c == '\t';
    if (!inside && (c == ',' || (blank && !by_comma))) {
      begin = true;
    } else if (opens(c) || closes(c)) {
      inside = opens(c);
    } else if (!blank && inside && !names.empty()) {
      names.back().unit += c;
    } else if (!blank && !inside) {
      if (begin) names.emplace_back();
      begin = false;
      names.back().text += c;
    }
  }
  return names;
}

/// "t", "timestamp", "time [s]" and the like; whatever begins with "time".
bool namesTime(const std::string& name) {
  return name == "t" || name == "ts" || name == "stamp" || name.rfind("time", 0) == 0;
}

std::optional<int> powerOf(const std::string& unit) {
  if (unit == "ns" || unit == "nsec") return 0;
  if (unit == "us" || unit == "usec") return 3;
  if (unit == "ms" || unit == "msec") return 6;
  if (unit == "s" || unit == "sec" || unit == "seconds") return 9;
  return std::nullopt;
}

// The column of the first name that begins and ends so; -1: none.
int columnOf(const std::vector<Name>& names, char first, char last) {
  for (std::size_t i = 1; i < names.size(); ++i) {
    const std::string& text = names[i].text;
    if (text.size() > 1 && text.front() == first && text.back() == last) return static_cast<int>(i);
  }
  return -1;
}

/// Three names in a row that end in x, y, z and begin with p or t: "tx", "px", "p_RS_R_x"; or the
/// axes alone.
/// From column 1 on, here and in columnOf(): column 0 is the stamp's.
std::optional<int> positionColumn(const std::vector<Name>& names) {
  for (std::size_t i = 1; i + 2 < names.size(); ++i) {
    const auto ends = [&](std::size_t j, char axis) {
      const std::string& text = names[j].text;
      const char kind = text.size() == 1 ? 'p' : text.front();
      return text.back() == axis && (kind == 'p' || kind == 't');
    };
    if (ends(i, 'x') && ends(i + 1, 'y') && ends(i + 2, 'z')) return static_cast<int>(i);
  }
  return std::nullopt;
}

std::optional<std::array<int, 4>> quaternionColumns(const std::vector<Name>& names) {
  const std::array<int, 4> columns = {columnOf(names, 'q', 'x'), columnOf(names, 'q', 'y'),
                                      columnOf(names, 'q', 'z'), columnOf(names, 'q', 'w')};
  const bool found = std::all_of(columns.begin(), columns.end(), [](int c) { return c > 0; });
  return found ? std::optional(columns) : std::nullopt;
}

}  // namespace

std::optional<TableHeader> parseTableHeader(std::string_view line) {
  while (!line.empty() && (line.front() == '#' || line.front() == ' ')) line.remove_prefix(1);
  const std::vector<Name> names = namesOf(line, line.find(',') != std::string_view::npos);
  // A stamp and a position at the least; any other comment is no header.
  if (names.size() < 4 || !namesTime(names.front().text)) return std::nullopt;
  TableHeader header;
  header.stamp_power = powerOf(names.front().unit);
  header.position = positionColumn(names);
  header.quaternion = quaternionColumns(names);
  if (!header.position) return std::nullopt;
  return header;
}

}  // namespace plumbline
