// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

#include "report/html/replay/sections.h"
#include "report/html/scene.h"

namespace plumbline::html_internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

template <class T>
double numberOf(const std::optional<T>& value) {
  return value ? static_cast<double>(*value) : kNone;
}

/// A column of the table of decisions: words as their place in the enumeration, nothing as NaN.
// Columns rather than objects: with a decision for every frame the names would be most of the page.
struct DecisionColumn {
  const char* name;
  double (*value)(const Decision&);
};

const DecisionColumn kColumns[] = {
    {"stage", [](const Decision& d) { return static_cast<double>(d.stage); }},
    {"mode", [](const Decision& d) { return static_cast<double>(d.mode); }},
    {"reason", [](const Decision& d) { return static_cast<double>(d.reason); }},
    {"accepted", [](const Decision& d) { return d.accepted ? 1.0 : 0.0; }},
    {"mi", [](const Decision& d) { return numberOf(d.mi_nats); }},
    {"entropy", [](const Decision& d) { return numberOf(d.entropy_nats); }},
    {"threshold", [](const Decision& d) { return d.threshold_nats; }},
    {"error", [](const Decision& d) { return numberOf(d.error_px); }},
    {"error_with", [](const Decision& d) { return numberOf(d.error_with_px); }},
    {"error_bound", [](const Decision& d) { return numberOf(d.error_bound_px); }},
    {"excess", [](const Decision& d) { return numberOf(d.excess); }},
    {"corners", [](const Decision& d) { return static_cast<double>(d.corners); }},
    {"kept", [](const Decision& d) { return static_cast<double>(d.views_kept); }},
    {"without", [](const Decision& d) { return static_cast<double>(d.frames_without_view); }},
    {"rmse", [](const Decision& d) { return numberOf(d.rmse_px); }},
    {"event", [](const Decision& d) { return static_cast<double>(d.event); }},
    {"suggestion", [](const Decision& d) { return numberOf(d.suggestion); }},
    {"distance", [](const Decision& d) { return numberOf(d.distance_px); }},
    {"held", [](const Decision& d) { return d.held_s; }}};

using ByFrame = std::vector<const Decision*>;  // null: the guide was not given the frame

/// Decisions by the position of their frame in the recording.
ByFrame byFrame(const ReplayRecord& record) {
  ByFrame decisions(frameCount(record), nullptr);
  for (const Decision& d : record.decisions) {
    if (d.frame >= 0) decisions[static_cast<std::size_t>(d.frame)] = &d;
  }
  return decisions;
}

TimeNs timeOf(const ReplayRecord& record, const ByFrame& decisions, std::size_t frame) {
  if (frame < record.frames.size()) return record.frames[frame].t;
  return decisions[frame] != nullptr ? decisions[frame]->t : 0;
}

Json tableJson(const ByFrame& decisions) {
  Json table = Json::object();
  std::vector<double> values(decisions.size());
  for (const DecisionColumn& column : kColumns) {
    std::transform(decisions.begin(), decisions.end(), values.begin(),
                   [&](const Decision* d) { return d != nullptr ? column.value(*d) : kNone; });
    // Raw bytes, which the page takes as a typed array: exact, and without a parser. Both sides are
    // little-endian.
    table[column.name] = base64(values);
  }
  return table;
}

/// Row by row of [R t], NaN without a pose.
void appendPose(std::vector<float>& cells, const std::optional<Transform>& T) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) cells.push_back(static_cast<float>(T ? T->R(i, j) : kNone));
    cells.push_back(static_cast<float>(T ? T->t[i] : kNone));
  }
}

/// T_FC0, twelve floats a frame.
std::string posesText(const ByFrame& decisions) {
  std::vector<float> cells;
  for (const Decision* d : decisions) appendPose(cells, d != nullptr ? d->T_FC0 : std::nullopt);
  return base64(cells);
}

/// Which ids a camera saw in each frame, a bit each, and where.
Json cornersJson(const ReplayRecord& record, std::size_t camera) {
  const auto bytes = static_cast<std::size_t>(record.target.cornerCount() + 7) / 8;
  std::vector<std::uint8_t> masks(frameCount(record) * bytes, 0);
  std::vector<std::int16_t> uv;
  for (std::size_t f = 0; f < record.frames.size(); ++f) {
    if (camera >= record.frames[f].corners.size()) continue;
    const std::vector<Corner>& corners = record.frames[f].corners[camera];
    for (const Corner& c : corners) {
      const auto id = static_cast<std::size_t>(c.id);
      // The lowest bit is the lowest id, as the page's script reads them.
      masks[f * bytes + id / 8] |= static_cast<std::uint8_t>(1U << (id % 8));
    }
    // The page gives them to the ids in ascending order, in which a view has its corners.
    const auto quarters = quarterPixels(corners);
    uv.insert(uv.end(), quarters.begin(), quarters.end());
  }
  return {{"masks", base64(masks)}, {"uv", base64(uv)}};
}

Json pointsJson(const std::vector<Eigen::Vector3d>& points) {
  Json cells = Json::array();
  for (const Eigen::Vector3d& p : points) {
    for (const double x : p) cells.push_back(std::round(1e5 * x) / 1e5);
  }
  return cells;
}

/// The camera; where none is known to the end, one of the size that its corners need.
CameraCalibration cameraOf(const ReplayRecord& record, std::size_t i) {
  CameraCalibration camera;
  if (i < record.cameras.size()) camera = record.cameras[i];
  if (camera.name.empty()) camera.name = "cam" + std::to_string(i);
  Resolution& size = camera.intrinsics.resolution;
  if (size.width > 0 && size.height > 0) return camera;
  size = {1, 1};
  for (const ReplayFrame& frame : record.frames) {
    if (i >= frame.corners.size()) continue;
    for (const Corner& c : frame.corners[i]) {
      // The pixel after the one that the corner lies in.
      size.width = std::max(size.width, static_cast<int>(c.uv.x()) + 2);
      size.height = std::max(size.height, static_cast<int>(c.uv.y()) + 2);
    }
  }
  return camera;
}

std::size_t cameraCount(const ReplayRecord& record) {
  std::size_t count = record.cameras.size();
  for (const ReplayFrame& frame : record.frames) count = std::max(count, frame.corners.size());
  return count;
}

Json camerasJson(const ReplayRecord& record) {
  Json cameras = Json::array();
  for (std::size_t i = 0; i < cameraCount(record); ++i) {
    const CameraCalibration c = cameraOf(record, i);
    const Colour colour = seriesColour(i);
    cameras.push_back({{"name", c.name},
                       {"width", c.intrinsics.resolution.width},
                       {"height", c.intrinsics.resolution.height},
                       {"colour", {colour.red, colour.green, colour.blue}},
                       {"frustum", pointsJson(frustum(c.intrinsics, c.T_C0Ci, 1))},
                       {"corners", cornersJson(record, i)}});
  }
  return cameras;
}

/// Corners as target.yaml states them, in F: the player draws no bent board.
Json targetJson(const AprilGrid& grid) {
  std::vector<float> points;
  for (int id = 0; id < grid.cornerCount(); ++id) {
    for (const double x : grid.corner(id)) points.push_back(static_cast<float>(x));
  }
  return {{"corners", grid.cornerCount()},
          {"width", grid.width()},
          {"height", grid.height()},
          {"margin", grid.tag_size * grid.spacing},
          {"points", base64(points)}};
}

Json detailsJson(const ByFrame& decisions) {
  Json details = Json::array();
  for (std::size_t f = 0; f < decisions.size(); ++f) {
    if (decisions[f] == nullptr || decisions[f]->detail.empty()) continue;
    details.push_back({f, decisions[f]->detail});
  }
  return details;
}

/// [frame, the frame at which it left the estimate again].
Json withdrawnJson(const ReplayRecord& record) {
  Json pairs = Json::array();
  for (const Decision& d : record.decisions) {
    for (const int frame : d.withdrawn) pairs.push_back({frame, d.frame});
  }
  return pairs;
}

Json eventsJson(const ReplayRecord& record) {
  Json events = Json::array();
  for (const ReplayEvent& e : replayEvents(record)) events.push_back({e.frame, e.kind, e.text});
  return events;
}

/// Nanoseconds since beginOf(); a double holds them exactly for 104 days.
Json timesJson(const ReplayRecord& record, const ByFrame& decisions) {
  std::vector<double> offsets;
  const TimeNs start = beginOf(record);
  for (std::size_t f = 0; f < decisions.size(); ++f) {
    offsets.push_back(static_cast<double>(timeOf(record, decisions, f) - start));
  }
  return {{"start", std::to_string(start)}, {"offsets", base64(offsets)}};
}

/// Of base64, and the end of its line.
std::size_t textSize(std::size_t bytes) { return (bytes + 2) / 3 * 4 + 1; }

std::vector<std::size_t> framesWithImages(const ReplayRecord& record) {
  std::vector<std::size_t> frames;
  for (std::size_t f = 0; f < record.frames.size(); ++f) {
    const auto& jpeg = record.frames[f].jpeg;
    const bool any = std::ranges::any_of(jpeg, [](const std::string& j) { return !j.empty(); });
    if (any) frames.push_back(f);
  }
  return frames;
}

/// Bytes of the text that the images of every `step`-th of the frames become.
std::size_t sizeOfEvery(std::size_t step, const ReplayRecord& record,
                        const std::vector<std::size_t>& frames) {
  std::size_t size = 0;
  for (std::size_t k = 0; k < frames.size(); k += step) {
    for (const std::string& jpeg : record.frames[frames[k]].jpeg) size += textSize(jpeg.size());
  }
  return size;
}

/// Images that fit, into `data`; returns what the script must know of them.
Json addImages(ReplayData& data, const ReplayRecord& record, std::size_t most_bytes) {
  const auto frames = framesWithImages(record);
  std::size_t step = 1;
  // The smallest step that fits: what is left out is left out evenly over the recording.
  while (step < frames.size() && sizeOfEvery(step, record, frames) > most_bytes) ++step;
  data.frames_with_images = static_cast<int>(frames.size());
  data.image_step = static_cast<int>(step);
  Json kept = Json::array();
  for (std::size_t k = 0; k < frames.size(); k += step) {
    kept.push_back(frames[k]);
    const auto& jpeg = record.frames[frames[k]].jpeg;
    for (std::size_t i = 0; i < cameraCount(record); ++i) {
      data.images += (i < jpeg.size() ? base64(jpeg[i]) : "") + '\n';
    }
  }
  return {{"frames", kept}, {"step", step}};
}

}  // namespace

std::size_t frameCount(const ReplayRecord& record) {
  std::size_t count = record.frames.size();
  for (const Decision& d : record.decisions) {
    // Frames that were not kept have their decisions yet.
    if (d.frame >= 0) count = std::max(count, static_cast<std::size_t>(d.frame) + 1);
  }
  return count;
}

ReplayData replayData(const ReplayRecord& record, std::size_t image_bytes, std::size_t bytes) {
  const ByFrame decisions = byFrame(record);
  const bool by_error = record.rule.by_error;
  Json json = {{"times", timesJson(record, decisions)},
               {"by_error", by_error},
               {"stop_excess",
                by_error && record.rule.stop_excess ? Json(*record.rule.stop_excess) : Json()},
               // The columns of an enumeration hold places in its words.
               {"words",
                {{"stage", enumWords(GuideStage())},
                 {"mode", enumWords(GuideMode())},
                 {"reason", enumWords(GuideReason())},
                 {"event", enumWords(SuggestionEvent())}}},
               {"table", tableJson(decisions)},
               {"poses", posesText(decisions)},
               {"withdrawn", withdrawnJson(record)},
               {"details", detailsJson(decisions)},
               {"target", targetJson(record.target)},
               {"cameras", camerasJson(record)},
               {"candidates", roundsJson(record)},
               {"suggestions", suggestionsJson(record)},
               {"events", eventsJson(record)}};
  ReplayData data;
  // Everything but the images, which get what is left.
  const std::size_t rest = json.dump().size();
  // Sizes are unsigned: the inner minimum keeps their difference from wrapping where the rest alone
  // is too large.
  json["images"] = addImages(data, record, std::min(image_bytes, bytes - std::min(bytes, rest)));
  data.json = scriptJson(json.dump());
  return data;
}

}  // namespace plumbline::html_internal
