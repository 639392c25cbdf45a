// SPDX-License-Identifier: BSD-3-Clause
// Exports of motion capture: Motive's and Vicon's, a frame a row, columns by body.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/transform.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

/// In place of the index of a column that a table lacks.
constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

/// Columns of a body's pose; without the rotation's w it is a vector.
struct Body {
  std::string name;
  std::array<std::size_t, 3> position = {kNoColumn, kNoColumn, kNoColumn};
  std::array<std::size_t, 4> rotation = {kNoColumn, kNoColumn, kNoColumn, kNoColumn};  // x, y, z, w

  /// A column of the position or the rotation; of another axis it is left out.
  void take(bool of_rotation, std::string_view axis, std::size_t column) {
    const std::size_t i = std::string_view("XYZW").find(axis);
    if (axis.size() != 1 || i > 3) return;
    if (of_rotation) rotation[i] = column;
    if (!of_rotation && i < 3) position[i] = column;
  }
};

/// The cell, empty where the row is shorter.
std::string_view cellAt(const Cells& cells, std::size_t i) {
  return i < cells.size() ? cells[i] : std::string_view();
}

/// Whether the row has these cells and all are empty: what was not seen.
bool areEmpty(const Cells& cells, std::span<const std::size_t> columns) {
  return std::ranges::all_of(columns,
                             [&](std::size_t c) { return c < cells.size() && cells[c].empty(); });
}

/// The body that `wanted` names, or the only one. Throws InputError with the names.
const Body& chooseBody(const TrajectorySource& source, const std::vector<Body>& bodies,
                       const std::string& wanted) {
  const auto found = std::ranges::find(bodies, wanted, &Body::name);
  if (!wanted.empty() && found != bodies.end()) return *found;
  if (wanted.empty() && bodies.size() == 1) return bodies.front();
  std::vector<std::string> names;
  for (const Body& body : bodies) names.push_back(body.name);
  throw source.fault(0, {InputFault::kAmbiguous,
                         wanted.empty() ? fmt::format("has {} bodies", names.size())
                                        : fmt::format("has no body '{}'", wanted),
                         fmt::format("the name of one of: {}", fmt::join(names, ", ")),
                         "choose the body by its name"});
}

/// Frames per second; `name` is what the export calls them.
double frameRate(const TrajectorySource& source, int line, const char* name,
                 std::string_view text) {
  const std::optional<double> rate = parseNumber(text);
  if (rate && *rate > 0 && std::isfinite(*rate)) return *rate;
  throw source.fault(line, {InputFault::kOutOfRange, fmt::format("the {} is '{}'", name, text),
                            "frames per second above 0", "export again"});
}

// In long double: beyond nine million frames the product leaves the 53 bits of a double.
TimeNs stampOf(double frame, double rate) {
  return std::llround(static_cast<long double>(frame) * 1e9L / rate);
}

/// `noun`: what the export calls a body.
void remarkOnSkipped(TrajectoryBuilder& builder, std::size_t skipped, std::size_t frames,
                     const char* noun) {
  if (skipped == 0) return;
  builder.remark(
      fmt::format("{} of {} frames are skipped: the {} was not seen", skipped, frames, noun));
}

// ---- Motive

struct Take {
  std::map<std::string, std::string, std::less<>> properties;  // of the first line
  std::vector<Body> bodies;
  std::size_t other_columns = 0;  // markers and the like
};

const std::string& property(const TrajectorySource& source, const Take& take, const char* name) {
  const auto found = take.properties.find(name);
  if (found != take.properties.end()) return found->second;
  throw source.fault(1, {InputFault::kMissingKey, fmt::format("the header has no '{}'", name),
                         "Motive's CSV with its header", "export again with the header"});
}

// Millimetres and the like to metres: what a position is divided by.
double lengthDivisor(const TrajectorySource& source, const Take& take) {
  const std::string& units = property(source, take, "Length Units");
  // A divisor: of a thousand the quotient is rounded once, while 0.001 is no double itself.
  if (units == "Meters") return 1;
  if (units == "Centimeters") return 100;
  if (units == "Millimeters") return 1000;
  throw source.fault(1, {InputFault::kWrongUnit, fmt::format("the length unit is '{}'", units),
                         "Meters, Centimeters or Millimeters", "export again in one of these"});
}

/// Quaternions, and poses in the room: anything else is refused rather than guessed at.
void checkConventions(const TrajectorySource& source, const Take& take) {
  const std::string& rotation = property(source, take, "Rotation Type");
  if (rotation != "Quaternion") {
    throw source.fault(
        1, {InputFault::kUnknownWord, fmt::format("the rotation type is '{}'", rotation),
            "Quaternion", "export again with quaternions"});
  }
  const auto space = take.properties.find("Coordinate Space");
  if (space != take.properties.end() && space->second != "Global") {
    throw source.fault(
        1, {InputFault::kUnknownWord, fmt::format("the coordinate space is '{}'", space->second),
            "Global", "export again in global coordinates"});
  }
}

Body& bodyNamed(Take& take, const std::string& name) {
  const auto found = std::ranges::find(take.bodies, name, &Body::name);
  return found != take.bodies.end() ? *found : take.bodies.emplace_back(Body{name});
}

// The rows between the first line and the frames: types, names, ids (and more), kinds, axes.
void takeColumns(Take& take, const std::vector<Cells>& rows) {
  const Cells& types = rows.front();
  const Cells& names = rows[1];
  // From the end: between names and kinds there may be more rows than the ids.
  const Cells& kinds = rows[rows.size() - 2];
  const Cells& axes = rows.back();
  // After the frame and its time.
  for (std::size_t c = 2; c < axes.size(); ++c) {
    if (cellAt(types, c) != "Rigid Body") {
      ++take.other_columns;
      continue;
    }
    Body& body = bodyNamed(take, std::string(cellAt(names, c)));
    // Others are figures such as Mean Marker Error.
    const std::string_view kind = cellAt(kinds, c);
    if (kind == "Rotation" || kind == "Position") body.take(kind == "Rotation", axes[c], c);
  }
}

// Up to and with the row of axes.
Take readTake(TextTable& table) {
  Take take;
  table.nextLine();
  const Cells pairs = table.cells();
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
    take.properties.emplace(pairs[i], pairs[i + 1]);
  }
  std::vector<Cells> rows;
  while (rows.empty() || rows.back().front() != "Frame") {
    // The header has a handful of rows; a file without the last of them is not searched to its end.
    if (!table.nextLine() || rows.size() > 10) {
      throw table.fault({InputFault::kMissingKey,
                         "no row 'Frame,Time (Seconds),...' follows the header",
                         "Motive's CSV with its header", "export again"});
    }
    if (!table.row().empty()) rows.push_back(table.cells());
  }
  // Fewer rows have no types, and so no rigid bodies: bodyOf() says so.
  if (rows.size() >= 4) takeColumns(take, rows);
  return take;
}

/// The body asked for, or the only one, with all seven columns of its pose.
const Body& bodyOf(const TrajectorySource& source, const Take& take, const std::string& wanted) {
  if (take.bodies.empty()) {
    throw source.fault(
        0, {InputFault::kMissingKey,
            fmt::format("has no rigid body ({} columns of markers or others)", take.other_columns),
            "columns of type Rigid Body",
            "define a rigid body in Motive, solve the take, export with rigid bodies"});
  }
  const Body& body = chooseBody(source, take.bodies, wanted);
  const auto lacking =
      std::ranges::count(body.position, kNoColumn) + std::ranges::count(body.rotation, kNoColumn);
  if (lacking == 0) return body;
  throw source.fault(
      0, {InputFault::kMissingKey, fmt::format("the rigid body '{}' lacks columns", body.name),
          "Rotation X Y Z W and Position X Y Z", "export again with both"});
}

struct BodyFrame {
  double number = 0;   // whole
  double seconds = 0;  // as the file rounds it
  std::optional<StampedPose> pose;
  int line = 0;
};

/// None where all cells of the body are empty: it was not seen.
std::optional<StampedPose> poseOf(const TextTable& table, const Cells& cells, const Body& body) {
  if (areEmpty(cells, body.position) && areEmpty(cells, body.rotation)) return std::nullopt;
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < 3; ++i) v[i] = table.numberIn(cells, body.position[i]);
  for (std::size_t i = 0; i < 4; ++i) v[3 + i] = table.numberIn(cells, body.rotation[i]);
  return StampedPose{0, {v[0], v[1], v[2]}, {v[6], v[3], v[4], v[5]}};
}

std::vector<BodyFrame> readFrames(TextTable& table, const Body& body) {
  std::vector<BodyFrame> frames;
  while (table.nextLine()) {
    if (table.row().empty()) continue;
    const Cells cells = table.cells();
    frames.push_back({std::round(table.numberIn(cells, 0)), table.numberIn(cells, 1),
                      poseOf(table, cells, body), table.line()});
  }
  return frames;
}

// The stamps from frame numbers must agree with the rounded Time column.
void checkTimes(const TrajectorySource& source, const std::vector<BodyFrame>& frames, double rate) {
  if (frames.empty()) return;
  const double span = (frames.back().number - frames.front().number) / rate;
  const double stated = frames.back().seconds - frames.front().seconds;
  // Two stamps, each off by its rounding.
  if (std::abs(span - stated) <= 2e-3) return;
  throw source.fault(frames.back().line,
                     {InputFault::kContradiction,
                      fmt::format("the frames span {:.3f} s at {} frames per second, but the Time "
                                  "column {:.3f} s",
                                  span, rate, stated),
                      "frame numbers that count at the export frame rate", "export again"});
}

// ---- Vicon

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

TrajectoryFile readMotive(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  TextTable table(source.path, source.text);
  const Take take = readTake(table);
  const Body& body = bodyOf(source, take, options.body);
  checkConventions(source, take);
  const double divisor = lengthDivisor(source, take);
  const double rate =
      frameRate(source, 1, "export frame rate", property(source, take, "Export Frame Rate"));
  const std::vector<BodyFrame> frames = readFrames(table, body);
  checkTimes(source, frames, rate);
  TrajectoryBuilder builder(source, TrajectoryFormat::kMotive, true);
  std::size_t occluded = 0;
  for (const BodyFrame& frame : frames) {
    if (!frame.pose) {
      ++occluded;
      continue;
    }
    // From the frame's number: the Time column is rounded.
    const TimeNs t = stampOf(frame.number, rate);
    builder.add({t, frame.pose->p / divisor, frame.pose->q}, frame.line);
  }
  builder.remark(fmt::format("rigid body '{}'; stamps count from frame 0 at {} frames per second",
                             body.name, rate));
  remarkOnSkipped(builder, occluded, frames.size(), "body");
  return std::move(builder).finish();
}

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
