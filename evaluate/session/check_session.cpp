// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "evaluate/metrics/coverage.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

// The line of a file that starts with `key`, from 1; 0 where there is none.
int lineOf(const std::string& key, const std::string& path) {
  std::ifstream file(path);
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    if (text.rfind(key, 0) == 0) return line;
  }
  return 0;
}

std::string placeOf(FaultyInput input, const LoadedSession& loaded, const std::string& session) {
  if (input == FaultyInput::kTarget) {
    const int line = lineOf("tagSize", loaded.target_path);
    return line > 0 ? fmt::format("{}:{}", loaded.target_path, line) : loaded.target_path;
  }
  const bool of_samples = input == FaultyInput::kImuSamples && !loaded.imu_samples_path.empty();
  return of_samples ? loaded.imu_samples_path : session;
}

constexpr int kFewPairs = 20;  // say nothing of tagCols
// In pixels the distortion of a wide lens changes cross ratios by some per cent.
constexpr double kRawTolerance = 0.15;
// Real boards in order have shown 4 % all the same (EuRoC's imu_april: 0.312 for 0.3).
constexpr double kTolerance = 0.1;

/// With tagCols wrong the "tag above" is another one: the edges of most pairs then stand beside
/// each other's line.
void checkColumns(const TargetLayout& layout, const LoadedSession& loaded) {
  if (layout.pairs_above < kFewPairs || 2 * layout.pairs_in_line >= layout.pairs_above) return;
  const std::string& path = loaded.target_path;
  throw InputError(
      path, lineOf("tagCols", path),
      fmt::format("tagCols is {}, but only {} of {} tags are aligned with the tag that this places "
                  "above them; expected the number of tags in a row; count them",
                  loaded.session.target.cols, layout.pairs_in_line, layout.pairs_above));
}

void checkSpacing(double shown, double tolerance, const LoadedSession& loaded) {
  const double stated = loaded.session.target.spacing;
  if (std::abs(shown / stated - 1) <= tolerance) return;
  const std::string& path = loaded.target_path;
  throw InputError(
      path, lineOf("tagSpacing", path),
      fmt::format("tagSpacing is {:g}, but the corners show gaps of {:.3g} times the tags' size; "
                  "expected the gap between tags as a ratio of tagSize; measure both on the target",
                  stated, shown));
}

}  // namespace

std::optional<Failure> noTagSeen(const LoadedSession& loaded) {
  std::size_t images = 0;
  for (const auto& of_camera : loaded.images) images += of_camera.size();
  const bool seen = std::any_of(loaded.counts.begin(), loaded.counts.end(),
                                [](const CameraCounts& c) { return c.views_with_corners > 0; });
  if (images == 0 || seen) return std::nullopt;
  return Failure{FailureCode::kNoTagSeen, {{"images", images}}};
}

Failure locate(Failure failure, const LoadedSession& loaded, const std::string& session) {
  failure.where = placeOf(failure.input(), loaded, session);
  return failure;
}

void locateSamples(const LoadedSession& loaded, Screening& screening) {
  const std::string& path = loaded.imu_samples_path;
  if ((screening.spikes.empty() && screening.pauses.empty()) || !path.ends_with(".csv")) return;
  std::map<std::string, int> lines;  // by the stamp as it is written
  for (const ImuSpike& spike : screening.spikes) lines[std::to_string(spike.t)] = 0;
  for (const ImuPause& pause : screening.pauses) lines[std::to_string(pause.t)] = 0;
  std::ifstream file(path);
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    const auto found = lines.find(text.substr(0, text.find(',')));
    if (found != lines.end()) found->second = line;
  }
  for (ImuSpike& spike : screening.spikes) spike.line = lines[std::to_string(spike.t)];
  for (ImuPause& pause : screening.pauses) pause.line = lines[std::to_string(pause.t)];
}

void checkTargetLayout(const LoadedSession& loaded, const std::vector<CameraCalibration>& cameras) {
  // The detector's figure first: images that contradict the stated spacing have few corners or
  // none, from which shownLayout() could tell.
  if (loaded.shown_spacing) checkSpacing(*loaded.shown_spacing, kTolerance, loaded);
  const TargetLayout layout = shownLayout(loaded.session, cameras);
  checkColumns(layout, loaded);
  // Pixels still hold the lens' distortion, plane coordinates behind known cameras do not.
  if (layout.spacing) {
    checkSpacing(*layout.spacing, cameras.empty() ? kRawTolerance : kTolerance, loaded);
  }
}

}  // namespace plumbline
