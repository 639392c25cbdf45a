// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <fmt/format.h>

#include "calibrator/fields/guide_fields.h"
#include "calibrator/fields/json_fields.h"
#include "calibrator/information/covariance.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/replay/replay_session.h"
#include "evaluate/results/text.h"

namespace plumbline {

std::string decisionLine(const Decision& decision) {
  // Every line has every key, null where there is nothing.
  JsonWriter writer(EmptyFields::kNull);
  // Lists of fields are for readers too, and take no constant.
  Decision copy = decision;
  fields(writer, copy);
  return writer.take().dump() + "\n";
}

std::string decisionLog(const std::vector<Decision>& decisions) {
  std::string text;
  for (const Decision& decision : decisions) text += decisionLine(decision);
  return text;
}

namespace {

void addStage(Text& text, const ReplayRecord& record, const ReplayStageSummary& s) {
  add(text, "{} stage: {} of {} frames used", toString(s.stage), s.views_used, s.frames_offered);
  // Hindsight is of the camera stage alone.
  if (s.stage == GuideStage::kCamera && s.kept_batch) {
    add(text, " ({}{} redundant, {} missed)", record.rule.by_error ? "by mutual information " : "",
        s.views_redundant, s.views_missed);
  }
  if (s.frames_dropped > 0) add(text, ", {} dropped", s.frames_dropped);
  add(text, "; {} suggestions, {} reached", s.suggestions, s.reached);
  if (s.finished) {
    add(text, "; finished at {:.1f} s", secondsBetween(beginOf(record), *s.finished));
  }
  if (s.ended) {
    add(text, "; ended at {:.1f} s without a stop", secondsBetween(beginOf(record), *s.ended));
  }
  add(text, "\n");
  // One entropy by itself says nothing: it depends on the units of its parameters.
  if (!s.kept_batch || !s.full_batch) return;
  add(text, "  entropy {:.2f} nats ({:.2f} bits); of all frames {:.2f} nats ({:.2f} bits)\n",
      s.kept_batch->entropy_nats, bitsFromNats(s.kept_batch->entropy_nats),
      s.full_batch->entropy_nats, bitsFromNats(s.full_batch->entropy_nats));
}

void addExcess(Text& text, const StopAudit& audit) {
  if (audit.predicted_excess && audit.measured_excess) {
    add(text,
        "  the views kept add {:.1f} % to a corner's error, as the guide predicted; on held-out "
        "frames {} (predicted), {:.1f} % (measured)\n",
        100 * *audit.predicted_excess,
        audit.held_out_excess ? fmt::format("{:.1f} %", 100 * *audit.held_out_excess) : "unknown",
        100 * *audit.measured_excess);
  }
  if (audit.predicted_px && audit.measured_px) {
    add(text, "  {} are off by {:.3f} px (expected), {:.3f} +- {:.3f} px (measured)\n",
        audit.stage == GuideStage::kCamera ? "projections" : "points that the IMU predicts",
        *audit.predicted_px, *audit.measured_px, audit.reference_std_px.value_or(0));
  }
}

void addCounterfactuals(Text& text, const Counterfactuals& c) {
  if (!c.problem.empty()) add(text, "counterfactual view orders: {}\n", c.problem);
  if (c.bands.empty()) return;
  add(text,
      "views until the held-out error is within 10 % of that of all {} ({:.4f} px):", c.pool_frames,
      c.full_pool_held_out_px);
  for (const CounterfactualBand& band : c.bands) {
    add(text, " {} {};", band.strategy,
        band.views_needed ? fmt::format("{:.0f}", band.views_needed->median) : notNeededText(band));
  }
  add(text, "\n");
}

}  // namespace

std::string replaySummary(const ReplayRecord& record) {
  Text text;
  if (!record.target.shape.isFlat()) add(text, "board: its shape is known and used\n");
  for (const ReplayStageSummary& stage : record.stages) {
    addStage(text, record, stage);
    for (const StopAudit& audit : record.stop_audits) {
      if (audit.stage == stage.stage) addExcess(text, audit);
    }
  }
  if (record.counterfactuals) addCounterfactuals(text, *record.counterfactuals);
  if (record.compliance) {
    const OperatorCompliance& c = *record.compliance;
    if (c.suggestions.empty()) {
      add(text, "operator: no suggestion was shown");
    } else {
      add(text, "operator: reached {} of {} suggestions", c.reached, endedSuggestions(c));
    }
    if (c.median_seconds_to_reach) add(text, ", median {:.1f} s", *c.median_seconds_to_reach);
    const std::size_t open = c.suggestions.size() - static_cast<std::size_t>(endedSuggestions(c));
    if (open > 0) add(text, "; {} open at the end", open);
    add(text, "\n");
  }
  add(text, "\n{}", verdictText(record.verdict));
  return fmt::to_string(text);
}

}  // namespace plumbline
