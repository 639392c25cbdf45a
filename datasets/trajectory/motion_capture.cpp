// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/trajectory/motion_capture.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/files/numbers.h"

namespace plumbline::capture_internal {

std::string_view cellAt(const Cells& cells, std::size_t i) {
  return i < cells.size() ? cells[i] : std::string_view();
}

bool areEmpty(const Cells& cells, std::span<const std::size_t> columns) {
  return std::ranges::all_of(columns,
                             [&](std::size_t c) { return c < cells.size() && cells[c].empty(); });
}

void refuseCutRow(const TextTable& table, const Cells& cells, std::size_t columns) {
  if (!table.truncatedHere() || cells.size() >= columns) return;
  throw table.fault({InputFault::kTruncated,
                     fmt::format("the last line has {} of {} columns", cells.size(), columns),
                     "a whole last line", table.rowCure()});
}

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

void remarkOnSkipped(TrajectoryBuilder& builder, std::size_t skipped, std::size_t frames,
                     const char* noun) {
  if (skipped == 0) return;
  builder.remark(
      fmt::format("{} of {} frames are skipped: the {} was not seen", skipped, frames, noun));
}

}  // namespace plumbline::capture_internal
