// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "datasets/trajectory/motion_capture.h"

namespace plumbline {
namespace {

using namespace capture_internal;

constexpr const char* kViconExport = "Vicon's CSV: 'Objects', the rate, names, columns, units";

struct ViconHeader {
  double rate = 0;
  Cells names;
  Cells columns;
  Cells units;
};

Cells nextCells(TextTable& table) {
  if (table.nextLine()) return table.cells();
  throw table.fault({InputFault::kTruncated, "the file ends in its header", kViconExport,
                     "the file is truncated: export it again"});
}

// Moves behind the line that begins the section of poses.
void findSection(const TrajectorySource& source, TextTable& table) {
  // Other sections may stand before it.
  while (table.nextLine()) {
    const Cells cells = table.cells();
    if (cells[0] == "Objects" || cells[0] == "Segments") return;
  }
  throw source.fault(
      0, {InputFault::kMissingKey, "has no section 'Objects' or 'Segments'", kViconExport,
          "trajectories of markers carry no orientation: export the objects"});
}

ViconHeader readViconHeader(const TrajectorySource& source, TextTable& table) {
  findSection(source, table);
  ViconHeader header;
  const Cells rate = nextCells(table);
  header.rate = frameRate(source, table.line(), "rate", rate[0]);
  header.names = nextCells(table);
  header.columns = nextCells(table);
  if (cellAt(header.columns, 0) != "Frame" || cellAt(header.columns, 1) != "Sub Frame") {
    throw table.fault({InputFault::kMissingKey, "is no row 'Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ'",
                       kViconExport, "export again"});
  }
  header.units = nextCells(table);
  return header;
}

// Tracker writes "Global Angle NAME" over the first column of an object.
std::string objectName(std::string_view cell) {
  constexpr std::string_view kPrefix = "Global Angle ";
  if (cell.starts_with(kPrefix)) cell.remove_prefix(kPrefix.size());
  return std::string(cell);
}

/// A name stands over the first of an object's columns, the others have none.
std::vector<Body> objectsOf(const ViconHeader& header) {
  std::vector<Body> objects;
  // After the frame and the sub frame.
  for (std::size_t c = 2; c < header.columns.size(); ++c) {
    const std::string_view name = cellAt(header.names, c);
    if (!name.empty()) objects.emplace_back().name = objectName(name);
    const std::string_view column = header.columns[c];
    if (objects.empty() || column.size() != 2) continue;
    if (column[0] == 'R' || column[0] == 'T') {
      objects.back().take(column[0] == 'R', column.substr(1), c);
    }
  }
  return objects;
}

struct Unit {
  std::string_view word;
  double divisor;  // 0.001 is no double itself: by a thousand the quotient is rounded once
};
constexpr std::array<Unit, 2> kLengths{{{"m", 1}, {"mm", 1000}}};
constexpr std::array<Unit, 2> kAngles{{{"rad", 1}, {"deg", 180 / std::numbers::pi}}};

/// Of an object's columns of one kind, which have one unit.
double unitDivisor(const TrajectorySource& source, int line, const Cells& units,
                   std::span<const std::size_t> columns, const std::array<Unit, 2>& known) {
  const std::string_view word = cellAt(units, columns.front());
  const auto unit = std::ranges::find(known, word, &Unit::word);
  const bool alike =
      std::ranges::all_of(columns, [&](std::size_t c) { return cellAt(units, c) == word; });
  if (unit != known.end() && alike) return unit->divisor;
  throw source.fault(
      line, {InputFault::kWrongUnit,
             alike ? fmt::format("the unit '{}' is unknown", word) : "the axes' units differ",
             "mm or m for TX TY TZ, rad or deg for RX RY RZ", "export again"});
}

/// The columns of an object's pose, and what their numbers are divided by.
struct ViconObject {
  Body columns;
  double length = 1;
  double angle = 1;

  bool isVector() const { return columns.rotation[3] == kNoColumn; }
};

ViconObject chooseObject(const TrajectorySource& source, int line, const ViconHeader& header,
                         const std::string& wanted) {
  const std::vector<Body> objects = objectsOf(header);
  ViconObject object{chooseBody(source, objects, wanted)};
  const auto& [name, position, rotation] = object.columns;
  const auto vector = std::span(rotation).first(3);
  if (std::ranges::count(position, kNoColumn) + std::ranges::count(vector, kNoColumn) > 0) {
    throw source.fault(0,
                       {InputFault::kMissingKey, fmt::format("the object '{}' lacks columns", name),
                        "RX RY RZ TX TY TZ", "export the objects' rotations and translations"});
  }
  object.length = unitDivisor(source, line, header.units, position, kLengths);
  if (object.isVector()) object.angle = unitDivisor(source, line, header.units, vector, kAngles);
  return object;
}

/// Exp of a rotation vector [rad].
Eigen::Quaterniond fromVector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

// Empty cells, or zeros throughout: the object was not seen. A position of exactly zero with no
// rotation is no measurement.
bool isSeen(const TextTable& table, const Cells& cells, const Body& object) {
  if (areEmpty(cells, object.position)) return false;
  const auto zero = [&](std::size_t c) { return table.numberIn(cells, c) == 0; };
  return !(std::ranges::all_of(object.position, zero) &&
           std::ranges::all_of(std::span(object.rotation).first(3), zero));
}

Eigen::Quaterniond rotationOf(const TextTable& table, const Cells& cells,
                              const ViconObject& object) {
  const auto at = [&](std::size_t i) { return table.numberIn(cells, object.columns.rotation[i]); };
  if (!object.isVector()) return {at(3), at(0), at(1), at(2)};
  const Eigen::Vector3d v = Eigen::Vector3d(at(0), at(1), at(2)) / object.angle;
  // A helical vector is never longer. Euler angles may pass, too: hence the remark of readVicon().
  if (v.allFinite() && v.norm() > 2 * std::numbers::pi * 1.001) {
    throw table.fault({InputFault::kNotRigid,
                       fmt::format("the rotation vector is {:.3f} rad long", v.norm()),
                       "at most a full turn",
                       "are RX RY RZ Euler angles, or is their unit another? Export with "
                       "helical angles or quaternions"});
  }
  return fromVector(v);
}

TimeNs viconStamp(const TextTable& table, const Cells& cells, double rate) {
  if (table.numberIn(cells, 1) == 0) return stampOf(table.numberIn(cells, 0), rate);
  throw table.fault({InputFault::kOutOfRange, "the sub frame is not 0", "whole frames",
                     "export at the cameras' rate"});
}

}  // namespace

TrajectoryFile readVicon(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  TextTable table(source.path, source.text);
  const ViconHeader header = readViconHeader(source, table);
  const ViconObject object = chooseObject(source, table.line(), header, options.body);
  const auto& [name, position, rotation] = object.columns;
  TrajectoryBuilder builder(source, TrajectoryFormat::kVicon, true);
  std::size_t frames = 0, occluded = 0;
  // An empty line ends the section; others may follow.
  for (; table.nextLine() && !table.row().empty(); ++frames) {
    const Cells cells = table.cells();
    refuseCutRow(table, cells, header.columns.size());
    const TimeNs t = viconStamp(table, cells, header.rate);
    if (!isSeen(table, cells, object.columns)) {
      ++occluded;
      continue;
    }
    const Eigen::Vector3d p(table.numberIn(cells, position[0]), table.numberIn(cells, position[1]),
                            table.numberIn(cells, position[2]));
    builder.add({t, p / object.length, rotationOf(table, cells, object)}, table.line());
  }
  builder.remark(fmt::format("object '{}'; stamps count from frame 0 at {} frames per second", name,
                             header.rate));
  if (object.isVector()) {
    builder.remark(
        "RX RY RZ are read as a rotation vector (Vicon's helical); an export as "
        "Euler angles has the same header and must be exported again");
  }
  remarkOnSkipped(builder, occluded, frames, "object");
  return std::move(builder).finish();
}

}  // namespace plumbline
