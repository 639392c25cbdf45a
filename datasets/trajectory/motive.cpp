// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "datasets/files/numbers.h"
#include "datasets/trajectory/motion_capture.h"

namespace plumbline {
namespace {

using namespace capture_internal;

struct Take {
  std::map<std::string, std::string, std::less<>> properties;  // of the first line
  std::vector<Body> bodies;
  std::size_t columns = 0;
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
  take.columns = rows.back().size();
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

std::vector<BodyFrame> readFrames(TextTable& table, const Body& body, std::size_t columns) {
  std::vector<BodyFrame> frames;
  while (table.nextLine()) {
    if (table.row().empty()) continue;
    const Cells cells = table.cells();
    refuseCutRow(table, cells, columns);
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

}  // namespace

TrajectoryFile readMotive(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  TextTable table(source.path, source.text);
  const Take take = readTake(table);
  const Body& body = bodyOf(source, take, options.body);
  checkConventions(source, take);
  const double divisor = lengthDivisor(source, take);
  const double rate =
      frameRate(source, 1, "export frame rate", property(source, take, "Export Frame Rate"));
  const std::vector<BodyFrame> frames = readFrames(table, body, take.columns);
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

}  // namespace plumbline
