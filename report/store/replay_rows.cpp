// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <cstdint>

#include "report/store/arrays.h"
#include "report/store/record_rows.h"
#include "report/store/shared_fields.h"

namespace plumbline {

// Corners are in arrays of their own, except those of suggestions.
template <class Archive>
void fields(Archive& a, Corner& c) {
  a("id", c.id);
  a("uv", c.uv);
}

template <class Archive>
void fields(Archive& a, Suggestion& s) {
  a("id", s.id);
  a("stage", s.stage);
  a("t", s.t);
  a("candidate", s.candidate);
  a("camera", s.camera);
  a("T_FC0", s.T_FC0);
  a("path", s.path);
  a("mi_nats", s.mi_nats);
}

template <class Archive>
void fields(Archive& a, CandidateRound& r) {
  a("asked", r.asked);
  a("answered", r.answered);
  a("names", r.names);
  a("T_FC0", r.T_FC0);
  a("mi_nats", r.mi_nats);
  a("best", r.best);
}

template <class Archive>
void fields(Archive& a, Decision& d) {
  a("t", d.t);
  a("frame", d.frame);
  a("stage", d.stage);
  a("mode", d.mode);
  a("reason", d.reason);
  a("accepted", d.accepted);
  a.added("withdrawn", d.withdrawn);
  a("mi_nats", d.mi_nats);
  a("entropy_nats", d.entropy_nats);
  a("threshold_nats", d.threshold_nats);
  a("corners", d.corners);
  a("views_kept", d.views_kept);
  a("frames_without_view", d.frames_without_view);
  a("rmse_px", d.rmse_px);
  a("T_FC0", d.T_FC0);
  a("event", d.event);
  a("suggestion", d.suggestion);
  a("distance_px", d.distance_px);
  a("held_s", d.held_s);
  a("opened", d.opened);
  a("round", d.round);
  a("detail", d.detail);
}

template <class Archive>
void fields(Archive& a, SuggestionOutcome& o) {
  a("suggestion", o.suggestion);
  a("overlay", o.overlay);
  a("end", o.end);
  a("ended", o.ended);
  a("closest_px", o.closest_px);
  a("mean_px", o.mean_px);
  a("closest_m", o.closest_m);
  a("closest_rad", o.closest_rad);
}

template <class Archive>
void fields(Archive& a, OperatorCompliance& c) {
  a("suggestions", c.suggestions);
  a("reached", c.reached);
  a("median_seconds_to_reach", c.median_seconds_to_reach);
}

template <class Archive>
void fields(Archive& a, StopAudit& s) {
  a("stage", s.stage);
  a("verdict", s.verdict);
  a("finished", s.finished);
  a("enough", s.enough);
  a("seconds", s.seconds);
  a("saved_s", s.saved_s);
  a("entropy_at_finish_nats", s.entropy_at_finish_nats);
  a("entropy_of_all_nats", s.entropy_of_all_nats);
  a("explanation", s.explanation);
}

template <class Archive>
void fields(Archive& a, ReplayStageSummary& s) {
  a("stage", s.stage);
  a("ran", s.ran);
  a("problem", s.problem);
  a("frames_offered", s.frames_offered);
  a("frames_dropped", s.frames_dropped);
  a("views_used", s.views_used);
  a("views_redundant", s.views_redundant);
  a("views_missed", s.views_missed);
  a("suggestions", s.suggestions);
  a("reached", s.reached);
  a("started", s.started);
  a("finished", s.finished);
  a("kept_batch", s.kept_batch);
  a("full_batch", s.full_batch);
  a("information_after_finish_nats", s.information_after_finish_nats);
}

template <class Archive>
void fields(Archive& a, Quartiles& q) {
  a("lower", q.lower);
  a("median", q.median);
  a("upper", q.upper);
}

template <class Archive>
void fields(Archive& a, CounterfactualCurve& c) {
  a("strategy", c.strategy);
  a("seed", c.seed);
  a("order", c.order);
  a("views", c.views);
  a("entropy_nats", c.entropy_nats);
  a("held_out_px", c.held_out_px);
  a("held_out_border_px", c.held_out_border_px);
  a("held_out_centre_px", c.held_out_centre_px);
  a("held_out_loss_px", c.held_out_loss_px);
  a("regret_px", c.regret_px);
  a("views_needed", c.views_needed);
}

template <class Archive>
void fields(Archive& a, CounterfactualBand& b) {
  a("strategy", b.strategy);
  a("seeds", b.seeds);
  a("views", b.views);
  a("entropy_nats", b.entropy_nats);
  a("held_out_px", b.held_out_px);
  a("regret_px", b.regret_px);
  a("views_needed", b.views_needed);
}

template <class Archive>
void fields(Archive& a, Counterfactuals& c) {
  a("curves", c.curves);
  a("bands", c.bands);
  a("pool_frames", c.pool_frames);
  a("held_out_frames", c.held_out_frames);
  a("full_pool_entropy_nats", c.full_pool_entropy_nats);
  a("full_pool_held_out_px", c.full_pool_held_out_px);
  a("other_model", c.other_model);
  a("other_model_bands", c.other_model_bands);
  a("remarks", c.remarks);
  a("problem", c.problem);
}

/// All but the frames.
template <class Archive>
void fields(Archive& a, ReplayRecord& r) {
  a("assumptions", r.assumptions);
  a("target", r.target);
  a("cameras", r.cameras);
  a("decisions", r.decisions);
  a("stages", r.stages);
  a("suggestions", r.suggestions);
  a("compliance", r.compliance);
  a("stop_audits", r.stop_audits);
  a("counterfactuals", r.counterfactuals);
}

namespace store_internal {
namespace {

constexpr const char* kCountElement = "n:i64, cameras within a frame";
constexpr const char* kCornerIdElement = "corner_id:i64";
constexpr const char* kPixelElement = "uv:f64[2]";
constexpr const char* kByteElement = "JPEG files one after the other";

/// The frames as columns. Counts and sizes have one entry per frame and camera.
struct FrameColumns {
  std::vector<TimeNs> t;
  std::vector<std::int64_t> counts, ids, jpeg_sizes;
  std::vector<Eigen::Vector2d> pixels;
  std::string jpegs;
};

FrameColumns columnsOf(const ReplayRecord& record) {
  FrameColumns columns;
  for (const ReplayFrame& frame : record.frames) {
    columns.t.push_back(frame.t);
    for (const std::vector<Corner>& corners : frame.corners) {
      columns.counts.push_back(static_cast<std::int64_t>(corners.size()));
      for (const Corner& corner : corners) {
        columns.ids.push_back(corner.id);
        columns.pixels.push_back(corner.uv);
      }
    }
    for (const std::string& jpeg : frame.jpeg) {
      columns.jpeg_sizes.push_back(static_cast<std::int64_t>(jpeg.size()));
      columns.jpegs += jpeg;
    }
  }
  return columns;
}

/// How many entries each frame has in a column; std::runtime_error where that is no whole number.
std::size_t perFrame(std::size_t entries, std::size_t frames) {
  if (frames == 0) return 0;
  if (entries % frames != 0) throw std::runtime_error("the frames' columns differ in length");
  return entries / frames;
}

/// Takes `count` entries from `at` on; std::runtime_error past the end.
std::size_t advance(std::size_t& at, std::int64_t count, std::size_t end) {
  const std::size_t begin = at;
  if (count < 0 || static_cast<std::size_t>(count) > end - begin) {
    throw std::runtime_error("a frame's column is cut short");
  }
  at += static_cast<std::size_t>(count);
  return begin;
}

std::vector<ReplayFrame> framesFrom(const FrameColumns& columns) {
  if (columns.ids.size() != columns.pixels.size()) {
    throw std::runtime_error("corners lack ids");
  }
  const std::size_t cameras = perFrame(columns.counts.size(), columns.t.size());
  const std::size_t images = perFrame(columns.jpeg_sizes.size(), columns.t.size());
  std::vector<ReplayFrame> frames(columns.t.size());
  std::size_t corner = 0;
  std::size_t byte = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    frames[f].t = columns.t[f];
    for (std::size_t c = 0; c < cameras; ++c) {
      std::size_t at = advance(corner, columns.counts[f * cameras + c], columns.ids.size());
      std::vector<Corner>& corners = frames[f].corners.emplace_back();
      for (; at < corner; ++at) {
        corners.push_back({static_cast<int>(columns.ids[at]), columns.pixels[at]});
      }
    }
    for (std::size_t c = 0; c < images; ++c) {
      const std::size_t at =
          advance(byte, columns.jpeg_sizes[f * images + c], columns.jpegs.size());
      frames[f].jpeg.push_back(columns.jpegs.substr(at, byte - at));
    }
  }
  return frames;
}

void addStageMetrics(std::vector<Metric>& metrics, const ReplayStageSummary& s, TimeNs begin) {
  const std::string stage = toString(s.stage);
  const auto count = [&](const char* name, int value) {
    metrics.push_back({stage, name, "1", static_cast<double>(value)});
  };
  count("ran", s.ran ? 1 : 0);
  count("frames_offered", s.frames_offered);
  count("frames_dropped", s.frames_dropped);
  count("views_used", s.views_used);
  count("views_redundant", s.views_redundant);
  count("views_missed", s.views_missed);
  count("suggestions", s.suggestions);
  count("suggestions_reached", s.reached);
  if (s.finished) {
    metrics.push_back({stage, "finish_s", "s", secondsBetween(begin, *s.finished)});
  }
  if (s.kept_batch) metrics.push_back({stage, "entropy_nats", "nat", s.kept_batch->entropy_nats});
  if (s.full_batch) {
    metrics.push_back({stage, "entropy_of_all_nats", "nat", s.full_batch->entropy_nats});
  }
}

std::vector<Metric> metricsOf(const ReplayRecord& record) {
  std::vector<Metric> metrics;
  const TimeNs begin = record.frames.empty() ? 0 : record.frames.front().t;
  for (const ReplayStageSummary& stage : record.stages) addStageMetrics(metrics, stage, begin);
  for (const StopAudit& audit : record.stop_audits) {
    metrics.push_back({toString(audit.stage), "stop_error_s", "s", audit.seconds});
    metrics.push_back({toString(audit.stage), "saved_s", "s", audit.saved_s});
  }
  return metrics;
}

}  // namespace

void writeRecord(RunWriter& run, const ReplayRecord& record) {
  run.metrics(metricsOf(record));
  run.document("replay", JsonWriter::toJson(record).dump());
  const FrameColumns columns = columnsOf(record);
  run.array("frames.t", kTimeElement, packNumbers(columns.t));
  run.array("frames.corner_count", kCountElement, packNumbers(columns.counts));
  run.array("frames.corner_id", kCornerIdElement, packNumbers(columns.ids));
  run.array("frames.uv", kPixelElement, packVectors(columns.pixels));
  run.array("frames.jpeg_size", kCountElement, packNumbers(columns.jpeg_sizes));
  run.array("frames.jpeg", kByteElement, columns.jpegs);
}

void readRecord(const RunReader& run, ReplayRecord& record) {
  JsonReader::fromJson(Json::parse(run.required("replay")), record);
  FrameColumns columns;
  columns.t = unpackNumbers<TimeNs>(run.array("frames.t", kTimeElement));
  columns.counts = unpackNumbers<std::int64_t>(run.array("frames.corner_count", kCountElement));
  columns.ids = unpackNumbers<std::int64_t>(run.array("frames.corner_id", kCornerIdElement));
  columns.pixels = unpackVectors<Eigen::Vector2d>(run.array("frames.uv", kPixelElement));
  columns.jpeg_sizes = unpackNumbers<std::int64_t>(run.array("frames.jpeg_size", kCountElement));
  columns.jpegs = run.array("frames.jpeg", kByteElement);
  record.frames = framesFrom(columns);
}

}  // namespace store_internal
}  // namespace plumbline
