// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "evaluate/metrics/target_layout.h"
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

/// Whether so many of the tags that are neighbours by target.yaml stand in line.
bool standInLine(const TargetLayout& layout, double share) {
  return layout.pairs_in_line >= share * layout.pairs_above &&
         layout.beside_in_line >= share * layout.pairs_beside;
}

constexpr double kHalf = 0.5;
constexpr double kNearlyAll = 0.8;  // to be believed in place of what is stated

/// The number of columns that puts the tags in line. From few up: rows above the next are in line
/// as well.
std::optional<int> columnsInLine(const Session& session,
                                 const std::vector<CameraCalibration>& cameras, int least,
                                 int most) {
  Session other;
  other.cameras = session.cameras;
  other.target = session.target;
  for (other.target.cols = least; other.target.cols <= most; ++other.target.cols) {
    const TargetLayout layout = shownLayout(other, cameras);
    if (layout.pairs_above >= kFewPairs && standInLine(layout, kNearlyAll))
      return other.target.cols;
  }
  return std::nullopt;
}

constexpr const char* kCornerWords[] = {"bottom-left", "bottom-right", "top-right", "top-left"};

/// The other order of a tag's corners in which this camera's tags stand in line.
std::optional<std::string> orderInLine(Session session,
                                       const std::vector<CameraCalibration>& cameras) {
  const std::vector<ImageView> views = session.cameras.front().views;
  for (int k = 1; k < 8; ++k) {
    std::array<int, 4> order{};  // ours, of the corners as they are numbered: turned, or reversed
    for (int i = 0; i < 4; ++i) order[static_cast<std::size_t>(i)] = (k < 4 ? k + i : k - i) % 4;
    for (std::size_t v = 0; v < views.size(); ++v) {
      for (std::size_t i = 0; i < views[v].corners.size(); ++i) {
        const int id = views[v].corners[i].id;
        session.cameras.front().views[v].corners[i].id =
            id - id % 4 + order[static_cast<std::size_t>(id % 4)];
      }
    }
    if (!standInLine(shownLayout(session, cameras), kNearlyAll)) continue;
    std::string words;
    for (const int corner : order)
      words += (words.empty() ? "" : ", ") + std::string(kCornerWords[corner]);
    return words;
  }
  return std::nullopt;
}

/// Each camera by itself, for they may come from different detectors: the order of its corners, and
/// whether it is mirrored.
void checkEachCamera(const LoadedSession& loaded, const std::vector<CameraCalibration>& cameras) {
  for (std::size_t c = 0; c < loaded.session.cameras.size(); ++c) {
    Session alone;
    alone.target = loaded.session.target;
    alone.cameras = {loaded.session.cameras[c]};
    std::vector<CameraCalibration> camera;
    if (!cameras.empty()) camera = {cameras[c]};
    const TargetLayout layout = shownLayout(alone, camera);
    const std::string file = loaded.session.cameras[c].name + "/corners.csv";
    if (layout.pairs_above + layout.pairs_beside < kFewPairs) continue;
    if (!standInLine(layout, kHalf)) {
      const auto order = orderInLine(std::move(alone), camera);
      if (!order) continue;
      throw InputError(
          file, 0,
          fmt::format("the corners of each tag are numbered {}; expected {}, {}, {}, {}; renumber "
                      "them (corner_id = 4 * tag + corner)",
                      *order, kCornerWords[0], kCornerWords[1], kCornerWords[2], kCornerWords[3]));
    }
    // Poses behind the board explain such corners as well as others do, so that no fit shows it.
    if (layout.mirrored > kHalf * layout.tags) {
      throw InputError(
          file, 0,
          fmt::format("the corners of {} of {} tags run clockwise, as on the target's back; "
                      "expected {}, {}, {}, {} counter-clockwise in the image; the images are "
                      "mirrored (u becomes width - 1 - u), or tags and corners are numbered so",
                      layout.mirrored, layout.tags, kCornerWords[0], kCornerWords[1],
                      kCornerWords[2], kCornerWords[3]));
    }
  }
}

/// With tagCols wrong the "tag above" is another one, and with corners in another order an edge is
/// no edge: most then stand beside each other's line. So they do where corners or ids are false,
/// and so the cause is tried before it is named.
void checkNeighbours(const TargetLayout& layout, const LoadedSession& loaded,
                     const std::vector<CameraCalibration>& cameras) {
  // One camera of several does not show in the sum of all.
  if (layout.pairs_above < kFewPairs || standInLine(layout, kHalf)) {
    return checkEachCamera(loaded, cameras);
  }
  const std::string& path = loaded.target_path;
  const int stated = loaded.session.target.cols;
  const auto tryColumns = [&](int least, int most) {
    const auto columns = columnsInLine(loaded.session, cameras, least, most);
    if (!columns || *columns == stated) return;
    throw InputError(
        path, lineOf("tagCols", path),
        fmt::format("tagCols is {}, but only {} of {} tags are aligned with the tag that this "
                    "places above them, and nearly all with {} columns; expected the number of "
                    "tags in a row; count them",
                    stated, layout.pairs_in_line, layout.pairs_above, *columns));
  };
  constexpr int kMostColumns = 40;
  tryColumns(2, kMostColumns);
  checkEachCamera(loaded, cameras);
  // Last: a single column has no tags beside each other, and any row does with corners turned.
  tryColumns(1, 1);
  throw InputError(
      path, 0,
      fmt::format("only {} of {} tags are aligned with the tag above them, and {} of {} with the "
                  "one beside them, by tagCols {}; neither another number of columns nor another "
                  "order of each tag's corners aligns them; expected the target of this recording "
                  "and its corners; look for false corners or ids of tags",
                  layout.pairs_in_line, layout.pairs_above, layout.beside_in_line,
                  layout.pairs_beside, stated));
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
  checkNeighbours(layout, loaded, cameras);
  // Pixels still hold the lens' distortion, plane coordinates behind known cameras do not.
  if (layout.spacing) {
    checkSpacing(*layout.spacing, cameras.empty() ? kRawTolerance : kTolerance, loaded);
  }
}

}  // namespace plumbline
