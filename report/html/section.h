// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/transform.h"
#include "report/html/figure.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

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

inline Cell number(std::string text) { return {std::move(text), Cell::Kind::kNumber, {}}; }
inline Cell tight(std::string text) { return {std::move(text), Cell::Kind::kTight, {}}; }
inline Cell code(std::string text) { return {std::move(text), Cell::Kind::kCode, {}}; }

struct Column {
  std::string name;  ///< with the unit: "RMSE [px]"
  Cell::Kind kind = Cell::Kind::kText;
};

struct Table {
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

struct NamedTransform {
  std::string name;
  Transform T;
  std::string note;
};

/// A part of a section: whatever is there, in the order of these fields.
struct Block {
  std::string heading;
  std::string text;
  std::optional<Table> table;
  std::vector<NamedTransform> matrices;
  std::vector<Figure> figures;
  std::string html = {};  ///< markup of its own, after the table
};

struct Section {
  std::string id, title, lead;
  std::vector<std::string> remarks;
  std::vector<Block> blocks;
};

/// `section` with a block of the table alone; as it is where the table has no rows.
inline Section withTable(Section section, Table table) {
  if (!table.rows.empty()) section.blocks.push_back({"", "", std::move(table), {}, {}});
  return section;
}

}  // namespace plumbline::html_internal
