// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

// Columns of a rigid body: position x y z and quaternion x y z w.
struct Body {
  std::string name;
  std::array<std::size_t, 7> columns = {kNoColumn, kNoColumn, kNoColumn, kNoColumn,
                                        kNoColumn, kNoColumn, kNoColumn};
};

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

double rateOf(const TrajectorySource& source, const Take& take) {
  const std::string& text = property(source, take, "Export Frame Rate");
  const std::optional<double> rate = parseNumber(text);
  if (rate && *rate > 0 && std::isfinite(*rate)) return *rate;
  throw source.fault(1,
                     {InputFault::kOutOfRange, fmt::format("the export frame rate is '{}'", text),
                      "frames per second above 0", "export again"});
}

// Where `kind` and `axis` belong in Body::columns; kNoColumn: elsewhere (Mean Marker Error).
std::size_t slotOf(const std::string& kind, const std::string& axis) {
  const std::size_t at = std::string("XYZW").find(axis);
  if (axis.size() != 1 || at == std::string::npos) return kNoColumn;
  if (kind == "Rotation") return 3 + at;
  return kind == "Position" && at < 3 ? at : kNoColumn;
}

Body& bodyNamed(Take& take, const std::string& name) {
  const auto found = std::find_if(take.bodies.begin(), take.bodies.end(),
                                  [&](const Body& body) { return body.name == name; });
  if (found != take.bodies.end()) return *found;
  take.bodies.push_back({name, Body().columns});
  return take.bodies.back();
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
    const std::size_t slot = slotOf(std::string(cellAt(kinds, c)), std::string(cellAt(axes, c)));
    if (slot != kNoColumn) body.columns[slot] = c;
  }
}

// Up to and with the row of axes.
Take readTake(const TrajectorySource& source, TextTable& table) {
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
      throw source.fault(table.line(), {InputFault::kMissingKey,
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
  std::vector<std::string> names;
  for (const Body& body : take.bodies) names.push_back(body.name);
  const Body& body = take.bodies[chooseBody(source, names, wanted)];
  if (std::count(body.columns.begin(), body.columns.end(), kNoColumn) == 0) return body;
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
  const auto empty = [&](std::size_t c) { return c < cells.size() && cells[c].empty(); };
  if (std::all_of(body.columns.begin(), body.columns.end(), empty)) return std::nullopt;
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < 7; ++i) v[i] = table.numberIn(cells, body.columns[i]);
  return StampedPose{0, {v[0], v[1], v[2]}, {v[6], v[3], v[4], v[5]}};
}

std::vector<BodyFrame> readFrames(TextTable& table, const Body& body) {
  std::vector<BodyFrame> frames;
  while (table.nextLine()) {
    if (table.row().empty()) continue;
    const Cells cells = table.cells();
    BodyFrame frame;
    frame.number = std::round(table.numberIn(cells, 0));
    frame.seconds = table.numberIn(cells, 1);
    frame.pose = poseOf(table, cells, body);
    frame.line = table.line();
    frames.push_back(frame);
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

std::size_t chooseBody(const TrajectorySource& source, const std::vector<std::string>& names,
                       const std::string& wanted) {
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (!wanted.empty() && found != names.end()) {
    return static_cast<std::size_t>(found - names.begin());
  }
  if (wanted.empty() && names.size() == 1) return 0;
  throw source.fault(0, {InputFault::kAmbiguous,
                         wanted.empty() ? fmt::format("has {} bodies", names.size())
                                        : fmt::format("has no body '{}'", wanted),
                         fmt::format("the name of one of: {}", fmt::join(names, ", ")),
                         "choose the body by its name"});
}

TrajectoryFile readMotive(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  TextTable table(source.path, source.text);
  const Take take = readTake(source, table);
  const Body& body = bodyOf(source, take, options.body);
  checkConventions(source, take);
  const double divisor = lengthDivisor(source, take);
  const double rate = rateOf(source, take);
  const std::vector<BodyFrame> frames = readFrames(table, body);
  checkTimes(source, frames, rate);
  TrajectoryBuilder builder(source, TrajectoryFormat::kMotive, true);
  std::size_t occluded = 0;
  for (const BodyFrame& frame : frames) {
    if (!frame.pose) {
      ++occluded;
      continue;
    }
    // From the frame's number: the Time column is rounded. In long double: beyond nine million
    // frames the product leaves the 53 bits of a double.
    const TimeNs t = std::llround(static_cast<long double>(frame.number) * 1e9L / rate);
    builder.add({t, frame.pose->p / divisor, frame.pose->q}, frame.line);
  }
  builder.remark(fmt::format("rigid body '{}'; stamps count from frame 0 at {} frames per second",
                             body.name, rate));
  if (occluded > 0) {
    builder.remark(
        fmt::format("{} of {} frames are skipped: the body was not seen", occluded, frames.size()));
  }
  return std::move(builder).finish();
}

}  // namespace plumbline
