// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

constexpr const char* kExport = "Vicon's CSV: 'Objects', the rate, names, columns, units";

// Columns of one object; without rw the rotation is a vector.
struct Object {
  std::string name;
  std::array<std::size_t, 3> translation = {kNoColumn, kNoColumn, kNoColumn};
  std::array<std::size_t, 4> rotation = {kNoColumn, kNoColumn, kNoColumn, kNoColumn};  // x, y, z, w
};

struct ViconHeader {
  double rate = 0;
  Cells names;
  Cells columns;
  Cells units;
};

Cells nextCells(const TrajectorySource& source, TextTable& table) {
  if (table.nextLine()) return table.cells();
  throw source.fault(table.line(), {InputFault::kTruncated, "the file ends in its header", kExport,
                                    "the file is truncated: export it again"});
}

// Moves behind the line that begins the section of poses.
void findSection(const TrajectorySource& source, TextTable& table) {
  // Other sections may stand before it.
  while (table.nextLine()) {
    const Cells cells = table.cells();
    if (cells[0] == "Objects" || cells[0] == "Segments") return;
  }
  throw source.fault(0, {InputFault::kMissingKey, "has no section 'Objects' or 'Segments'", kExport,
                         "trajectories of markers carry no orientation: export the objects"});
}

ViconHeader readViconHeader(const TrajectorySource& source, TextTable& table) {
  findSection(source, table);
  ViconHeader header;
  const Cells rate = nextCells(source, table);
  header.rate = parseNumber(rate[0]).value_or(0);
  if (!(header.rate > 0 && std::isfinite(header.rate))) {
    throw source.fault(table.line(),
                       {InputFault::kOutOfRange, fmt::format("the rate is '{}'", rate[0]),
                        "frames per second above 0", "export again"});
  }
  header.names = nextCells(source, table);
  header.columns = nextCells(source, table);
  if (cellAt(header.columns, 0) != "Frame" || cellAt(header.columns, 1) != "Sub Frame") {
    throw source.fault(table.line(),
                       {InputFault::kMissingKey, "is no row 'Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ'",
                        kExport, "export again"});
  }
  header.units = nextCells(source, table);
  return header;
}

// Tracker writes "Global Angle NAME" over the first column of an object.
std::string objectName(std::string_view cell) {
  constexpr std::string_view kPrefix = "Global Angle ";
  if (cell.substr(0, kPrefix.size()) == kPrefix) cell.remove_prefix(kPrefix.size());
  return std::string(cell);
}

/// A name stands over the first of an object's columns, the others have none.
std::vector<Object> objectsOf(const ViconHeader& header) {
  std::vector<Object> objects;
  // After the frame and the sub frame.
  for (std::size_t c = 2; c < header.columns.size(); ++c) {
    const std::string_view name = cellAt(header.names, c);
    if (!name.empty()) objects.emplace_back().name = objectName(name);
    if (objects.empty() || header.columns[c].size() != 2) continue;
    const std::size_t axis = std::string_view("XYZW").find(header.columns[c][1]);
    if (axis == std::string_view::npos) continue;
    if (header.columns[c][0] == 'R') objects.back().rotation[axis] = c;
    if (header.columns[c][0] == 'T' && axis < 3) objects.back().translation[axis] = c;
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
  const auto unit =
      std::find_if(known.begin(), known.end(), [&](const Unit& u) { return u.word == word; });
  const bool alike = std::all_of(columns.begin(), columns.end(),
                                 [&](std::size_t c) { return cellAt(units, c) == word; });
  if (unit != known.end() && alike) return unit->divisor;
  throw source.fault(
      line, {InputFault::kWrongUnit,
             alike ? fmt::format("the unit '{}' is unknown", word) : "the axes' units differ",
             "mm or m for TX TY TZ, rad or deg for RX RY RZ", "export again"});
}

Object chooseObject(const TrajectorySource& source, const ViconHeader& header,
                    const std::string& wanted) {
  const std::vector<Object> objects = objectsOf(header);
  std::vector<std::string> names;
  for (const Object& object : objects) names.push_back(object.name);
  const Object& object = objects.at(chooseBody(source, names, wanted));
  const auto missing = std::count(object.translation.begin(), object.translation.end(), kNoColumn) +
                       std::count(object.rotation.begin(), object.rotation.begin() + 3, kNoColumn);
  if (missing == 0) return object;
  throw source.fault(
      0, {InputFault::kMissingKey, fmt::format("the object '{}' lacks columns", object.name),
          "RX RY RZ TX TY TZ", "export the objects' rotations and translations"});
}

/// Exp of a rotation vector [rad].
Eigen::Quaterniond fromVector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

class ViconReader {
 public:
  ViconReader(const TrajectorySource& source, const std::string& wanted)
      : source_(source),
        table_(source.path, source.text),
        header_(readViconHeader(source, table_)),
        object_(chooseObject(source, header_, wanted)),
        builder_(source, TrajectoryFormat::kVicon, true) {
    const int line = table_.line();
    length_ = unitDivisor(source_, line, header_.units, object_.translation, kLengths);
    if (!isVector()) return;
    angle_ =
        unitDivisor(source_, line, header_.units, std::span(object_.rotation).first(3), kAngles);
  }

  TrajectoryFile read() {
    int frames = 0;
    // An empty line ends the section; others may follow.
    for (; table_.nextLine() && !table_.row().empty(); ++frames) takeFrame();
    builder_.remark(fmt::format("object '{}'; stamps count from frame 0 at {} frames per second",
                                object_.name, header_.rate));
    if (isVector()) {
      builder_.remark(
          "RX RY RZ are read as a rotation vector (Vicon's helical); an export as "
          "Euler angles has the same header and must be exported again");
    }
    if (occluded_ > 0) {
      builder_.remark(
          fmt::format("{} of {} frames are skipped: the object was not seen", occluded_, frames));
    }
    return std::move(builder_).finish();
  }

 private:
  bool isVector() const { return object_.rotation[3] == kNoColumn; }

  double number(const Cells& cells, std::size_t column) const {
    return table_.numberIn(cells, column);
  }

  // Empty cells, or zeros throughout: the object was not seen. A position of exactly zero with no
  // rotation is no measurement.
  bool seen(const Cells& cells) const {
    const auto empty = [&](std::size_t c) { return c < cells.size() && cells[c].empty(); };
    if (std::all_of(object_.translation.begin(), object_.translation.end(), empty)) return false;
    const auto zero = [&](std::size_t c) { return number(cells, c) == 0; };
    return !(std::all_of(object_.translation.begin(), object_.translation.end(), zero) &&
             std::all_of(object_.rotation.begin(), object_.rotation.begin() + 3, zero));
  }

  Eigen::Quaterniond rotation(const Cells& cells) const {
    const auto at = [&](std::size_t i) { return number(cells, object_.rotation[i]); };
    if (!isVector()) return {at(3), at(0), at(1), at(2)};
    const Eigen::Vector3d v = Eigen::Vector3d(at(0), at(1), at(2)) / angle_;
    // A helical vector is never longer. Euler angles may pass, too: hence the remark in read().
    if (v.allFinite() && v.norm() > 2 * std::numbers::pi * 1.001) {
      throw source_.fault(
          table_.line(),
          {InputFault::kNotRigid, fmt::format("the rotation vector is {:.3f} rad long", v.norm()),
           "at most a full turn",
           "are RX RY RZ Euler angles, or is their unit another? Export with "
           "helical angles or quaternions"});
    }
    return fromVector(v);
  }

  TimeNs stamp(const Cells& cells) const {
    if (number(cells, 1) != 0) {
      throw source_.fault(table_.line(), {InputFault::kOutOfRange, "the sub frame is not 0",
                                          "whole frames", "export at the cameras' rate"});
    }
    // In long double, as Motive's frames are.
    return std::llround(static_cast<long double>(number(cells, 0)) * 1e9L / header_.rate);
  }

  void takeFrame() {
    const Cells cells = table_.cells();
    const TimeNs t = stamp(cells);
    if (!seen(cells)) {
      ++occluded_;
      return;
    }
    const auto& columns = object_.translation;
    const Eigen::Vector3d p(number(cells, columns[0]), number(cells, columns[1]),
                            number(cells, columns[2]));
    builder_.add({t, p / length_, rotation(cells)}, table_.line());
  }

  const TrajectorySource& source_;
  TextTable table_;
  ViconHeader header_;
  Object object_;
  TrajectoryBuilder builder_;
  double length_ = 1;  // divisors
  double angle_ = 1;
  int occluded_ = 0;
};

}  // namespace

TrajectoryFile readVicon(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  return ViconReader(source, options.body).read();
}

}  // namespace plumbline
