// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/trajectory/trajectory_reader.h"

#include <algorithm>
#include <iterator>

#include "datasets/files/file_io.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

// The number of cells in a line of numbers.
std::size_t countCells(std::string_view line) {
  std::size_t cells = 0;
  bool inside = false;
  for (const char c : line) {
    const bool separator = c == ',' || c == ' ' || c == '\t';
    if (!separator && !inside) ++cells;
    inside = !separator;
  }
  return cells;
}

/// The words with which Vicon's exports begin a section.
bool beginsViconSection(std::string_view line) {
  constexpr std::string_view kSections[] = {"Objects",       "Segments", "Trajectories", "Joints",
                                            "Model Outputs", "Devices",  "Markers"};
  const std::string_view first = line.substr(0, line.find(','));
  return std::ranges::find(kSections, first) != std::end(kSections);
}

// From the first line that says something. Tables tell TUM from EuRoC themselves.
std::optional<TrajectoryFormat> formatOf(std::string_view text) {
  TextLines lines(text);
  while (lines.next()) {
    const std::string_view line = lines.text();
    if (line.empty()) continue;
    if (line.starts_with("Format Version")) return TrajectoryFormat::kMotive;
    if (beginsViconSection(line)) return TrajectoryFormat::kVicon;
    if (parseTableHeader(line)) return std::nullopt;
    if (line[0] == '#') continue;
    // No other table without a header has twelve: TUM's have 8 or 20 columns, EuRoC's 4, 8, 11 or
    // 17.
    return countCells(line) == 12 ? std::optional(TrajectoryFormat::kKitti) : std::nullopt;
  }
  return std::nullopt;
}

// `format` empty: a table of poses.
// An option that would do nothing shows that the file is not what its user takes it for.
void refuseIdle(const TrajectorySource& source, const TrajectoryReadOptions& options,
                std::optional<TrajectoryFormat> format) {
  const bool mocap = format == TrajectoryFormat::kMotive || format == TrajectoryFormat::kVicon;
  if (!options.body.empty() && !mocap) {
    throw BadInput(InputFault::kBadOption, source.path, 0,
                   "has no rigid bodies to choose '" + options.body +
                       "' from; only exports of Motive and Vicon do");
  }
  if (options.times.empty() || format == TrajectoryFormat::kKitti) return;
  throw BadInput(InputFault::kBadOption, options.times.string(), 0,
                 "stamps in a file of their own belong to KITTI's poses");
}

TrajectoryFile readText(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  const auto format = options.format ? options.format : formatOf(source.text);
  refuseIdle(source, options, format);
  if (format == TrajectoryFormat::kMotive) return readMotive(source, options);
  if (format == TrajectoryFormat::kVicon) return readVicon(source, options);
  if (format == TrajectoryFormat::kKitti) return readKitti(source, options);
  TrajectoryFile file = readPoseTable(source, options);
  if (!options.format) correctKalibrPoses(source, file);
  return file;
}

}  // namespace

TrajectoryFile readTrajectory(const std::filesystem::path& path,
                              const TrajectoryReadOptions& options) {
  if (path == "-") {
    const std::string text = readStandardInput();
    return readText({"standard input", text}, options);
  }
  const MappedFile file(path.string());
  return readText({path.string(), file.text()}, options);
}

}  // namespace plumbline
