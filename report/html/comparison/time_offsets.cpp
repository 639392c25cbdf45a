// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "report/html/comparison/sections.h"
#include "report/html/page.h"

namespace plumbline::html_internal {
namespace {

/// One column a calibration: camera 0's offset as a tool writes it.
Table offsetTable(const ComparisonRecord& record) {
  Table table{{words("Tool"), code("Field")}};
  std::vector<std::vector<OffsetRow>> rows;
  for (const OffsetSummary& o : record.offsets) {
    table.columns.push_back(number(o.label));
    // The mean of the cameras' is for comparing: no tool has it.
    const auto offset =
        o.per_camera_s.empty() ? o.time_offset_s : std::optional(o.per_camera_s.front());
    rows.push_back(offset ? offsetRows(*offset, o.std_s) : std::vector<OffsetRow>());
  }
  table.columns.push_back(words("Note"));
  // Tools, fields and notes are those of any offset.
  const auto tools = offsetRows(0, std::nullopt);
  for (std::size_t i = 0; i < tools.size(); ++i) {
    std::vector<Cell> cells = {{tools[i].tool}, code(tools[i].field)};
    for (const auto& column : rows) {
      cells.push_back(number(column.empty()
                                 ? "\u2013 (no IMU)"
                                 : fmt::format("{} ({})", column[i].number, column[i].value)));
    }
    cells.push_back({tools[i].note});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// By calibration, where its cameras are not synchronised.
std::string unlikeOffsets(const ComparisonRecord& record) {
  std::string text;
  for (const ComparedCalibration& c : record.calibrations) {
    if (!c.calibration.imu) continue;
    const std::string own = unlikeOffsetsText(c.calibration.cameras, *c.calibration.imu);
    if (!own.empty()) text += (text.empty() ? "" : " ") + c.label + ": " + own;
  }
  return text;
}

/// Offset, deviation and, where cameras have one each, theirs; all in Kalibr's sign.
Table offsetDetails(const ComparisonRecord& record) {
  Table table{
      {words("Calibration"), number("t_d [ms]"), number("Std [ms]"), number("Per camera [ms]")}};
  for (const OffsetSummary& o : record.offsets) {
    std::string each;
    for (const double t : o.per_camera_s) {
      each += (each.empty() ? "" : ", ") + withPrecisionOf(1e3 * t, 1e3 * o.std_s.value_or(0));
    }
    table.rows.push_back(
        {{o.label},
         number(o.time_offset_s ? withPrecisionOf(1e3 * *o.time_offset_s, 1e3 * o.std_s.value_or(0))
                                : "\u2013 (no IMU)"),
         number(o.std_s ? twoDigits(1e3 * *o.std_s) : "\u2013 (not stated)"),
         number(each.empty() ? "\u2013 (one for all)" : each)});
  }
  return table;
}

}  // namespace

Section offsetsSection(const ComparisonRecord& record) {
  Section section{"time-offset", "Time offset in every tool's sign",
                  "The convention here, and Kalibr's, is t_imu = t_cam + t_d: a camera stamp plus "
                  "the offset is the same instant on the IMU's clock."};
  if (record.offsets.empty()) return section;
  section.blocks.push_back({"", "", offsetDetails(record)});
  section.blocks.push_back({"As written by each tool", unlikeOffsets(record), offsetTable(record)});
  return section;
}

}  // namespace plumbline::html_internal
