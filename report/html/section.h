// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// A plot with the sentence or two that tell what to look for.
struct Figure {
  std::string svg;
  std::string caption;
  bool wide = false;  ///< takes the whole width of the page
};

struct Cell {
  enum class Kind { kText, kNumber, kCode, kTight };  ///< kTight: never wrapped
  std::string text;
  Kind kind = Kind::kText;
  std::optional<VerdictLevel> level = {};  ///< a dot of its colour before the text
  std::string link = {};                   ///< relative address that the text leads to
  bool best = false;                       ///< the best of its row: bold
};

inline constexpr auto kNumber = Cell::Kind::kNumber;
inline constexpr const char* kDash = "\u2013";  ///< in the cell of a value that there is not

inline Cell number(std::string text) { return {std::move(text), Cell::Kind::kNumber}; }
inline Cell number(std::integral auto count) { return number(std::to_string(count)); }
/// Of values in this format.
template <class Value, class... Values>
Cell number(fmt::format_string<Value, Values...> format, Value&& value, Values&&... values) {
  return number(fmt::format(format, std::forward<Value>(value), std::forward<Values>(values)...));
}
/// A number of this format (fmt's), or a dash where there is none.
Cell orDash(const std::optional<double>& value, double factor, const char* format);
inline Cell words(std::string text) { return {std::move(text)}; }
inline Cell tight(std::string text) { return {std::move(text), Cell::Kind::kTight}; }
inline Cell code(std::string text) { return {std::move(text), Cell::Kind::kCode}; }

struct Table {
  std::vector<Cell> columns;  ///< names with the unit ("RMSE [px]"), and the kind of their cells
  std::vector<std::vector<Cell>> rows = {};
};

/// Takes columns out of the table.
inline void eraseColumns(Table& table, std::ptrdiff_t first, std::ptrdiff_t count = 1) {
  const auto erase = [&](std::vector<Cell>& row) {
    row.erase(row.begin() + first, row.begin() + first + count);
  };
  erase(table.columns);
  std::ranges::for_each(table.rows, erase);
}

struct NamedTransform {
  std::string name;
  Transform T;
  std::string note;
};

/// A part of a section: whatever is there, in the order of these fields.
struct Block {
  std::string heading = {};
  std::string text = {};
  std::optional<Table> table = {};
  std::vector<NamedTransform> matrices = {};
  std::vector<Figure> figures = {};
  std::string html = {};  ///< markup of its own, after the table
};

/// A block of figures alone.
inline Block figureBlock(std::string heading, std::vector<Figure> figures) {
  return {std::move(heading), "", {}, {}, std::move(figures)};
}

struct Section {
  std::string id, title, lead;
  std::vector<Block> blocks = {};
  std::vector<std::string> remarks = {};  ///< before the blocks
};

/// `section` with a block of the table; as it is where the table has no rows.
inline Section withTable(Section section, Table table, const std::string& heading = "",
                         const std::string& text = "") {
  if (!table.rows.empty()) section.blocks.push_back({heading, text, std::move(table)});
  return section;
}

/// `section` with a block of the figures that show something; as it is where none does.
inline Section withFigures(Section section, std::vector<Figure> figures) {
  std::erase_if(figures, [](const Figure& figure) { return figure.svg.empty(); });
  if (!figures.empty()) section.blocks.push_back(figureBlock("", std::move(figures)));
  return section;
}

}  // namespace plumbline::html_internal
