// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "calibrator/base/guide_decision.h"
#include "calibrator/fields/guide_fields.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// A frame as the operator would have seen it.
struct ReplayFrame {
  TimeNs t = 0;
  std::vector<std::vector<Corner>> corners;
  std::vector<std::string> jpeg;  ///< empty where the recording has none
};

void fields(auto& v, ReplayFrame& f) {
  v("t_ns", f.t, "stamp");
  v("corners", f.corners, "per camera");
  v("jpeg", f.jpeg, "per camera, a small JPEG of its image");
}

/// How a suggestion ended.
struct SuggestionOutcome {
  Suggestion suggestion;
  SuggestionEvent end = SuggestionEvent::kNone;
  TimeNs ended = 0;
  std::optional<double> reached_s;  ///< empty: it was not
  std::optional<double> closest_px, mean_px, closest_m, closest_rad;
  /// Per camera, what it would see at suggestion.T_FC0, by the record's cameras and not those that
  /// the guide had then. Empty: nothing is overlaid.
  std::vector<std::vector<Corner>> overlay;
};

void fields(auto& v, SuggestionOutcome& o) {
  fields(v, o.suggestion);
  v("end", o.end,
    "`reached`, `expired`, `withdrawn` (for the next one, or as the stage ended); `none`: open at "
    "the end");
  v("ended_ns", o.ended, "when");
  v("reached_s", o.reached_s, "s", "how long it took to reach it; `reach_s` was predicted");
  v("closest_px", o.closest_px, "px", "least mean corner distance while it was open");
  v("mean_px", o.mean_px, "px", "mean of the distance over its frames");
  v("closest_m", o.closest_m, "m", "least distance of the camera's position");
  v("closest_rad", o.closest_rad, "rad", "and of its orientation, at that instant");
  v.array("overlay", o.overlay, "what each camera would see there");
}

/// What a guided recording says of its operator: suggestions as they were shown at recording time.
struct OperatorCompliance {
  std::vector<SuggestionOutcome> suggestions;
  int reached = 0;
  std::optional<double> median_seconds_to_reach;
};

void fields(auto& v, OperatorCompliance& c) {
  v("suggestions", c.suggestions, "as they were shown at recording time");
  v("reached", c.reached, "1", "of them");
  v("median_seconds_to_reach", c.median_seconds_to_reach, "s", "of those reached");
}

/// What an operator can be judged by: one that was open when the frames ended was neither reached
/// nor missed.
inline int endedSuggestions(const OperatorCompliance& c) {
  return static_cast<int>(std::ssize(c.suggestions) - std::ranges::count(c.suggestions,
                                                                         SuggestionEvent::kNone,
                                                                         &SuggestionOutcome::end));
}

/// Was the guide's "finish" right? Judged by how far the calibration of the frames kept by then is
/// from that of all frames, and by the deviation of the latter.
struct StopAudit {
  enum class Verdict { kNeverStopped, kEarly, kLate, kRight, kNotJudged };
  GuideStage stage = GuideStage::kCamera;
  Verdict verdict = Verdict::kNeverStopped;
  std::optional<TimeNs> finished, ended, enough;
  std::optional<bool> all_suffice;
  double seconds = 0, saved_s = 0;
  /// Of the camera stage.
  std::optional<double> predicted_excess, held_out_excess, measured_excess;
  std::optional<double> predicted_px, measured_px, reference_std_px;
  double entropy_at_finish_nats = 0, entropy_of_all_nats = 0;
  std::string explanation;
};

constexpr std::array<const char*, 5> enumWords(StopAudit::Verdict /*of*/) {
  return {"never stopped", "early", "late", "right", "not judged"};
}
inline std::string partName(const StopAudit& a) { return toString(a.stage); }

void fields(auto& v, StopAudit& a) {
  v("stage", a.stage, "`camera` or `camera-imu`");
  v("verdict", a.verdict, "`right`, `early`, `late`, `never stopped`, `not judged`");
  v("finished_ns", a.finished, "the guide's \"finish\"");
  v("ended_ns", a.ended, "the stage was ended here without one");
  v("enough_ns", a.enough, "first instant at which the frames kept were sufficient");
  v("all_suffice", a.all_suffice, "1",
    "whether the deviations of all frames' calibration are within the bars; null: not judged");
  v("seconds", a.seconds, "s",
    "early: missing; late: wasted; never stopped: until its end, after the frames were sufficient");
  v("saved_s", a.saved_s, "s", "of the recording, after \"finish\"");
  v("predicted_excess", a.predicted_excess, "1",
    "share by which the views kept raise the error, as predicted by the guide for its later use");
  v("held_out_excess", a.held_out_excess, "1",
    "likewise predicted, with the held-out frames as later use");
  v("measured_excess", a.measured_excess, "1", "measured on these frames, against all frames");
  v("predicted_px", a.predicted_px, "px",
    "error (RMS) as expected by the guide: camera stage: of the worst camera's projections, with "
    "`--stop-projection-px`; camera-IMU stage: of points that the IMU predicts");
  v("measured_px", a.measured_px, "px",
    "distance in the same of the calibration of the frames kept from that of all frames");
  v("reference_std_px", a.reference_std_px, "px", "standard deviation of the latter");
  v("entropy_at_finish_nats", a.entropy_at_finish_nats, "nat", "of the calibration parameters");
  v("entropy_of_all_nats", a.entropy_of_all_nats, "nat", "had every frame been used");
  v("explanation", a.explanation, "a sentence with the numbers that decided it");
}

/// One stage in figures.
struct ReplayStageSummary {
  GuideStage stage = GuideStage::kCamera;
  bool ran = false;
  std::string problem;
  int frames_offered = 0, frames_dropped = 0;
  int views_used = 0, views_redundant = 0, views_missed = 0;
  int suggestions = 0, reached = 0;
  std::optional<TimeNs> started, finished, ended;
  std::optional<StageSummary> kept_batch, full_batch;
  double information_after_finish_nats = 0;
};

inline std::string partName(const ReplayStageSummary& s) { return toString(s.stage); }

void fields(auto& v, ReplayStageSummary& s) {
  v("stage", s.stage, "`camera` or `camera-imu`");
  v("ran", s.ran, "1", "whether it did");
  v.ifSet("problem", s.problem, "why it did not run, or not to its end");
  v("frames_offered", s.frames_offered, "1", "of the recording");
  v("frames_dropped", s.frames_dropped, "1", "came while the guide was busy");
  v("views_used", s.views_used, "1", "accepted");
  v("views_redundant", s.views_redundant, "1",
    "used, but in hindsight each is below the threshold");
  v("views_missed", s.views_missed, "1",
    "not used, but in hindsight each is at the threshold or above");
  v("suggestions", s.suggestions, "1", "of the guide");
  v("suggestions_reached", s.reached, "1", "of them");
  v("started_ns", s.started, "the frame with which its estimate began");
  v("finished_ns", s.finished, "the guide's \"finish\"");
  v("ended_ns", s.ended, "the stage was ended here without \"finish\"");
  std::optional<double> duration_s;
  if (s.started && s.finished) duration_s = secondsBetween(*s.started, *s.finished);
  v.derived("duration_s", duration_s, "s", "from start to \"finish\"");
  v("kept_batch", s.kept_batch, "batch over the kept views");
  v("full_batch", s.full_batch, "batch over all frames of the recording");
  v("information_after_finish_nats", s.information_after_finish_nats, "nat",
    "what the recording after \"finish\" added");
  v.derived("information_after_finish_bits", inBits(s.information_after_finish_nats), "bit",
            "the same in bits");
}

/// One order in which the frames of a pool could have been used.
struct CounterfactualCurve {
  std::string strategy;
  std::uint64_t seed = 0;
  std::vector<int> order, views;
  std::vector<std::optional<double>> entropy_nats, held_out_px;
  std::vector<std::optional<double>> held_out_border_px, held_out_centre_px;
  /// What the batch means to make small, while the RMSE counts gross errors fully. Equal to
  /// held_out_px without a loss.
  std::vector<std::optional<double>> held_out_loss_px;
  /// A strategy with seeds stands there with its median. Negative where one seed beats every
  /// strategy.
  std::vector<std::optional<double>> regret_px;
  std::optional<int> views_needed;
};

void fields(auto& v, CounterfactualCurve& c) {
  v("strategy", c.strategy,
    "`recorded`, `random`, `greedy-mi`, `predicted-error`, `coverage`, `guide`");
  v.ifSet("seed", c.seed, "of a random order");
  v("views", c.views, "abscissa: how many were used");
  v("entropy_nats", c.entropy_nats, "at each; null: not determined yet");
  v("held_out_px", c.held_out_px, "RMSE on frames outside the pool");
  v("held_out_border_px", c.held_out_border_px, "over corners near the image's border");
  v("held_out_centre_px", c.held_out_centre_px, "over the others");
  v("held_out_loss_px", c.held_out_loss_px, "under the batch's loss, sqrt(mean rho(|e|^2))");
  v("regret_px", c.regret_px, "`held_out_px` minus that of the best strategy at as many views");
  v("views_needed", c.views_needed,
    "to come within 10 % of the full pool's held-out error and stay there");
  v("order", c.order, "frames of the pool, as positions in the recording's frames");
}

struct Quartiles {
  double lower = 0, median = 0, upper = 0;
};
inline auto elements(Quartiles& q) { return std::tie(q.lower, q.median, q.upper); }

/// The curves of one strategy over its seeds; of a strategy without, all three quartiles agree.
struct CounterfactualBand {
  std::string strategy;
  int seeds = 0;
  std::vector<int> views;
  std::vector<std::optional<Quartiles>> entropy_nats, held_out_px;
  std::vector<std::optional<double>> regret_px;
  std::optional<Quartiles> views_needed;
};

void fields(auto& v, CounterfactualBand& b) {
  v("strategy", b.strategy, "whose curves");
  v("seeds", b.seeds, "number of curves");
  v("views", b.views, "abscissa");
  v("entropy_nats_quartiles", b.entropy_nats, "`[lower, median, upper]`; null: not all have one");
  v("held_out_px_quartiles", b.held_out_px, "likewise");
  v("regret_px", b.regret_px, "of the median");
  v("views_needed_quartiles", b.views_needed, "absent: not all seeds get there");
}

/// What is said in place of views_needed where that is empty. An order may end before the pool
/// does.
inline std::string notNeededText(const CounterfactualBand& band) {
  const int most = band.views.empty() ? 0 : band.views.back();
  return (band.seeds > 1 ? "not by every seed within " : "not within ") + std::to_string(most) +
         " views";
}

struct Counterfactuals {
  std::vector<CounterfactualCurve> curves;
  std::vector<CounterfactualBand> bands;  ///< in the order of the curves
  int pool_frames = 0, held_out_frames = 0;
  double full_pool_entropy_nats = 0, full_pool_held_out_px = 0;
  std::string other_model;  ///< empty: none was tried
  std::vector<CounterfactualBand> other_model_bands;
  std::vector<std::string> remarks;
  std::string problem;  ///< one line, with its cure
};

void fields(auto& v, Counterfactuals& c) {
  v("pool_frames", c.pool_frames, "1", "frames to choose from");
  v("held_out_frames", c.held_out_frames, "1", "frames to judge on");
  v("full_pool_entropy_nats", c.full_pool_entropy_nats, "nat", "with all of the pool");
  v("full_pool_held_out_px", c.full_pool_held_out_px, "px", "likewise");
  v("bands", c.bands, "one per strategy");
  v("curves", c.curves, "one per strategy and seed");
  v("remarks", c.remarks, "where and why a strategy loses, from the numbers");
  v.group("other_model", [&](auto& g) {
    g.ifSet("model", c.other_model, "`pinhole-equidistant`, ...");
    g.ifSet("bands", c.other_model_bands, "greedy-mi and random under it");
  });
  v.ifSet("problem", c.problem, "why there are no curves");
}

/// By what the guide chose, and when it stopped.
struct GuideRule {
  bool by_error = false;              ///< predicted errors decided, and not gains
  std::optional<double> stop_excess;  ///< of the camera stage; empty: it stopped by something else
};

void fields(auto& v, GuideRule& r) {
  v("by_error", r.by_error, "whether predicted errors decided, and not mutual information");
  v("stop_excess", r.stop_excess, "1",
    "`excess` at which the camera stage finishes; absent: it finishes by something else");
}

/// A replay: every decision of the guide on a recording, and how good they were.
struct ReplayRecord {
  std::string name;
  Provenance provenance;
  Assumptions assumptions;
  Verdict verdict;
  GuideRule rule;
  AprilGrid target;
  std::vector<CameraCalibration> cameras;
  std::vector<ReplayFrame> frames;
  std::optional<TimeNs> begin;
  std::vector<Decision> decisions;
  std::vector<ReplayStageSummary> stages;
  std::vector<SuggestionOutcome> suggestions;
  std::optional<OperatorCompliance> compliance;
  std::vector<StopAudit> stop_audits;
  std::optional<Counterfactuals> counterfactuals;
};

/// Where times into the recording count from; a record that kept no frames has decisions.
inline TimeNs beginOf(const ReplayRecord& record) {
  if (record.begin) return *record.begin;
  if (!record.frames.empty()) return record.frames.front().t;
  return record.decisions.empty() ? 0 : record.decisions.front().t;
}

/// replay.json.
void fields(auto& v, ReplayRecord& r) {
  v.derived("schema", 1, "", "version of this format");
  v("session", r.name, "its name");
  v.derived("frames", r.frames.size(), "1", "of the recording");
  v("begin_ns", r.begin,
    "stamp of the first frame, or of the one that replaced a first frame with a wrong stamp: "
    "where times into the recording count from");
  v("rule", r.rule, "by what the guide chose views and trajectories, and stopped");
  v("stages", r.stages, "each stage in figures");
  v("stop_audits", r.stop_audits, "stopping rule: was the guide's \"finish\" right?");
  v("suggestions", r.suggestions, "how each ended");
  v("compliance", r.compliance, "what a guided recording says of its operator");
  v("counterfactuals", r.counterfactuals, "other orders in which frames could have been used");
  v("target", r.target, "the AprilGrid");
  v("cameras", r.cameras, "for drawing: the best that is known at the end");
  v("assumptions", r.assumptions, "assumptions of the entropies");
  v("verdict", r.verdict, "what the replay shows");
  v("provenance", r.provenance, "where the result comes from");
  v.array("frames", r.frames, "all of the recording");
  v.array("decisions", r.decisions, "one per frame; also `decisions.jsonl`");
}

}  // namespace plumbline
