// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "report/plots/base64.h"
#include "report/plots/plot_data.h"
#include "report/records/calibration_record.h"
#include "report/records/image_map.h"

namespace plumbline::html_internal {

/// `value` with as many decimals as show two digits of `std` ("458.654" for 0.080); six significant
/// digits where std is not a positive number.
std::string withPrecisionOf(double value, double std);

/// Two significant digits ("0.080", "1.2e-05").
std::string twoDigits(double value);

/// Seconds in the unit that leaves one to three digits before the point ("13.6 \u00b5s"), with as
/// many decimals as show two digits of `std`; three significant digits where std is not positive.
std::string scaledSeconds(double seconds, double std);

/// Thousands apart by thin spaces ("358 210").
std::string grouped(std::size_t count);

/// Whether a noise check tells a density. A group of less redundancy than the check moves
/// (kLeastRedundancy in camera_imu/noise.cpp) keeps a factor of 1, which says nothing.
inline bool tellsDensity(const ImuNoiseCheck& check) { return check.redundancy >= 10; }

/// A quantity in the unit in which people read it: m as mm, rad as degrees, s as ms.
struct ReadableUnit {
  std::string unit;
  double factor = 1;
};
ReadableUnit readable(const std::string& unit);

/// Index of the name; their number where it is not among them.
inline std::size_t placeOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

/// The names of the rows, each once, in the order of their first.
template <class Rows, class Name>
std::vector<std::string> distinct(const Rows& rows, const Name& name) {
  std::vector<std::string> names;
  for (const auto& row : rows) {
    if (placeOf(names, name(row)) == names.size()) names.push_back(name(row));
  }
  return names;
}

/// JSON as it may stand in a script element: nothing in it looks like the element's end.
std::string scriptJson(const std::string& json);

using internal::base64;

/// Rounded to a whole number, and cut where 16 bits end: a cell of data in base64.
inline std::int16_t shortCell(double value) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -32767.0, 32767.0)));
}

/// A plot with the sentence or two that tell what to look for.
struct Figure {
  std::string svg;
  std::string caption;
  bool wide = false;  ///< takes the whole width of the page
};

/// Adds those of the values that are finite to `known`.
void addFinite(const std::vector<double>& values, std::vector<double>& known);

/// "at 1 m", "at infinity".
std::string rangeText(double range_m);

/// Pixels between neighbouring points of the grid.
double stepX(const ImageMap& map);
double stepY(const ImageMap& map);

/// Whether the map has a grid, an image, and a value for each point.
bool sound(const ImageMap& map);

/// Axes of a plot over the image, wider by `margin` steps on each side.
PlotFrame mapFrame(const ImageMap& map, const std::string& title, double margin);

/// The values with lines of equal value; scaleAlike() gives maps that are compared one scale.
HeatMap heatMap(const ImageMap& map, const std::string& title, const std::string& label);

/// With median, largest value and clamp in the caption.
Figure heatFigure(const HeatMap& plot, const std::string& id);

/// One colour scale for maps that a reader compares: 0 to the 98 % quantile of all their cells, so
/// that one cell does not pale the rest.
void scaleAlike(const std::vector<HeatMap*>& maps);

/// " Colours end at 0.81 px; the largest is 3.2 px." where a cell of the map lies above its scale.
std::string clampText(const HeatMap& map);

/// One magnification for fields that a reader compares: an arrow of the 90 % quantile of all spans
/// `reach` on the axes; the key shows a round length; arrows above twice the quantile are cut.
void magnifyAlike(const std::vector<VectorField*>& fields, double reach);

/// " 3 arrows above 0.62 px are cut there and red." where some are.
std::string cutText(const VectorField& field);

/// Pointers to all of them, as scaleAlike() and magnifyAlike() take.
template <class Plot>
std::vector<Plot*> addressesOf(std::vector<Plot>& plots) {
  std::vector<Plot*> addresses;
  for (Plot& plot : plots) addresses.push_back(&plot);
  return addresses;
}

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
