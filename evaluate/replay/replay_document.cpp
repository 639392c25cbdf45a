// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/replay_document.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibrator/information/covariance.h"
#include "evaluate/results/json_values.h"
#include "evaluate/results/record_json.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

Json batchJson(const StageSummary& s) {
  Json parameters = Json::array();
  for (std::size_t i = 0; i < s.covariance.names.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    parameters.push_back({{"name", s.covariance.names[i]},
                          {"unit", s.covariance.units[i]},
                          {"std", std::sqrt(s.covariance.matrix(row, row))}});
  }
  return {{"rmse_px", s.reprojection.rmse_px},
          {"views_used", s.views_used},
          {"corners_used", s.corners_used},
          {"entropy_nats", finiteJson(s.entropy_nats)},
          {"entropy_bits", finiteJson(bitsFromNats(s.entropy_nats))},
          {"parameters", parameters}};
}

Json stageJson(const ReplayStageSummary& s) {
  Json json{
      {"stage", toString(s.stage)},
      {"ran", s.ran},
      {"frames_offered", s.frames_offered},
      {"frames_dropped", s.frames_dropped},
      {"views_used", s.views_used},
      {"views_redundant", s.views_redundant},
      {"views_missed", s.views_missed},
      {"suggestions", s.suggestions},
      {"suggestions_reached", s.reached},
      {"started_ns", optionalJson(s.started)},
      {"finished_ns", optionalJson(s.finished)},
      {"information_after_finish_nats", finiteJson(s.information_after_finish_nats)},
      {"information_after_finish_bits", finiteJson(bitsFromNats(s.information_after_finish_nats))}};
  if (!s.problem.empty()) json["problem"] = s.problem;
  if (s.kept_batch) json["kept_batch"] = batchJson(*s.kept_batch);
  if (s.full_batch) json["full_batch"] = batchJson(*s.full_batch);
  return json;
}

Json outcomeJson(const SuggestionOutcome& o) {
  return {{"id", o.suggestion.id},
          {"stage", toString(o.suggestion.stage)},
          {"t_ns", o.suggestion.t},
          {"candidate", o.suggestion.candidate},
          {"mi_bits", finiteJson(bitsFromNats(o.suggestion.mi_nats))},
          {"mi_nats", finiteJson(o.suggestion.mi_nats)},
          {"end", toString(o.end)},
          {"ended_ns", o.ended},
          {"closest_px", optionalJson(o.closest_px)},
          {"mean_px", optionalJson(o.mean_px)},
          {"closest_m", optionalJson(o.closest_m)},
          {"closest_rad", optionalJson(o.closest_rad)}};
}

Json outcomesJson(const std::vector<SuggestionOutcome>& outcomes) {
  Json json = Json::array();
  for (const SuggestionOutcome& outcome : outcomes) json.push_back(outcomeJson(outcome));
  return json;
}

const char* wordOf(StopAudit::Verdict verdict) {
  switch (verdict) {
    case StopAudit::Verdict::kNotJudged:
      return "not judged";
    case StopAudit::Verdict::kNeverStopped:
      return "never stopped";
    case StopAudit::Verdict::kEarly:
      return "early";
    case StopAudit::Verdict::kLate:
      return "late";
    case StopAudit::Verdict::kRight:
      return "right";
  }
  return "";
}

Json auditJson(const StopAudit& a) {
  return {{"stage", toString(a.stage)},
          {"verdict", wordOf(a.verdict)},
          {"finished_ns", optionalJson(a.finished)},
          {"enough_ns", optionalJson(a.enough)},
          {"seconds", a.seconds},
          {"saved_s", a.saved_s},
          {"entropy_at_finish_nats", finiteJson(a.entropy_at_finish_nats)},
          {"entropy_of_all_nats", finiteJson(a.entropy_of_all_nats)},
          {"explanation", a.explanation}};
}

Json quartilesJson(const std::optional<Quartiles>& q) {
  return q ? Json{q->lower, q->median, q->upper} : Json();
}

Json curveJson(const CounterfactualCurve& c) {
  Json json{{"strategy", c.strategy}};
  if (c.seed != 0) json["seed"] = c.seed;
  json["views"] = c.views;
  json["entropy_nats"] = optionalsJson(c.entropy_nats);
  json["held_out_px"] = optionalsJson(c.held_out_px);
  json["held_out_border_px"] = optionalsJson(c.held_out_border_px);
  json["held_out_centre_px"] = optionalsJson(c.held_out_centre_px);
  json["regret_px"] = optionalsJson(c.regret_px);
  json["views_needed"] = optionalJson(c.views_needed);
  json["order"] = c.order;
  return json;
}

Json bandsJson(const std::vector<CounterfactualBand>& bands) {
  Json json = Json::array();
  for (const CounterfactualBand& band : bands) {
    Json entropy = Json::array();
    Json error = Json::array();
    for (const auto& q : band.entropy_nats) entropy.push_back(quartilesJson(q));
    for (const auto& q : band.held_out_px) error.push_back(quartilesJson(q));
    json.push_back({{"strategy", band.strategy},
                    {"seeds", band.seeds},
                    {"views", band.views},
                    {"entropy_nats_quartiles", entropy},
                    {"held_out_px_quartiles", error},
                    {"regret_px", optionalsJson(band.regret_px)},
                    {"views_needed_quartiles", quartilesJson(band.views_needed)}});
  }
  return json;
}

Json counterfactualsJson(const Counterfactuals& c) {
  Json curves = Json::array();
  for (const CounterfactualCurve& curve : c.curves) curves.push_back(curveJson(curve));
  Json json{{"pool_frames", c.pool_frames},
            {"held_out_frames", c.held_out_frames},
            {"full_pool_entropy_nats", finiteJson(c.full_pool_entropy_nats)},
            {"full_pool_held_out_px", finiteJson(c.full_pool_held_out_px)},
            {"bands", bandsJson(c.bands)},
            {"curves", curves},
            {"remarks", c.remarks}};
  if (!c.other_model.empty()) {
    json["other_model"] = {{"model", c.other_model}, {"bands", bandsJson(c.other_model_bands)}};
  }
  if (!c.problem.empty()) json["problem"] = c.problem;
  return json;
}

Json complianceJson(const OperatorCompliance& c) {
  return {{"suggestions", outcomesJson(c.suggestions)},
          {"reached", c.reached},
          {"median_seconds_to_reach", c.median_seconds_to_reach}};
}

void addStage(Text& text, const ReplayRecord& record, const ReplayStageSummary& s) {
  add(text, "{} stage: {} of {} frames used", toString(s.stage), s.views_used, s.frames_offered);
  if (s.stage == GuideStage::kCamera && s.kept_batch) {
    add(text, " ({} redundant, {} missed)", s.views_redundant, s.views_missed);
  }
  if (s.frames_dropped > 0) add(text, ", {} dropped", s.frames_dropped);
  add(text, "; {} suggestions, {} reached", s.suggestions, s.reached);
  if (s.finished) {
    add(text, "; finished at {:.1f} s", secondsBetween(record.frames.front().t, *s.finished));
  }
  add(text, "\n");
  if (!s.kept_batch || !s.full_batch) return;
  add(text, "  entropy {:.2f} nats ({:.2f} bits); of all frames {:.2f} nats ({:.2f} bits)\n",
      s.kept_batch->entropy_nats, bitsFromNats(s.kept_batch->entropy_nats),
      s.full_batch->entropy_nats, bitsFromNats(s.full_batch->entropy_nats));
}

void addCounterfactuals(Text& text, const Counterfactuals& c) {
  if (!c.problem.empty()) add(text, "other choices of views: {}\n", c.problem);
  if (c.bands.empty()) return;
  add(text,
      "views until the held-out error is within 10 % of that of all {} ({:.4f} px):", c.pool_frames,
      c.full_pool_held_out_px);
  for (const CounterfactualBand& band : c.bands) {
    add(text, " {} {};", band.strategy,
        band.views_needed ? fmt::format("{:.0f}", band.views_needed->median) : "not reached");
  }
  add(text, "\n");
}

}  // namespace

std::string replayDocument(const ReplayRecord& record) {
  Json stages = Json::array();
  for (const ReplayStageSummary& stage : record.stages) stages.push_back(stageJson(stage));
  Json audits = Json::array();
  for (const StopAudit& audit : record.stop_audits) audits.push_back(auditJson(audit));
  Json document{{"schema", kSchema},
                {"session", record.name},
                {"frames", record.frames.size()},
                {"stages", stages},
                {"stop_audits", audits},
                {"suggestions", outcomesJson(record.suggestions)}};
  if (record.compliance) document["compliance"] = complianceJson(*record.compliance);
  if (record.counterfactuals) {
    document["counterfactuals"] = counterfactualsJson(*record.counterfactuals);
  }
  document["assumptions"] = assumptionsJson(record.assumptions);
  document["verdict"] = verdictJson(record.verdict);
  document["provenance"] = provenanceJson(record.provenance);
  return document.dump(2) + "\n";
}

std::string replaySummary(const ReplayRecord& record) {
  Text text;
  for (const ReplayStageSummary& stage : record.stages) addStage(text, record, stage);
  if (record.counterfactuals) addCounterfactuals(text, *record.counterfactuals);
  if (record.compliance) {
    add(text, "operator: reached {} of {} suggestions, median {:.1f} s\n",
        record.compliance->reached, record.compliance->suggestions.size(),
        record.compliance->median_seconds_to_reach);
  }
  add(text, "\nVerdict: {}\n", toString(record.verdict.level));
  for (const Finding& f : record.verdict.findings) {
    add(text, "  {:<9} {}: {}\n", toString(f.level), f.rule, f.evidence);
  }
  return fmt::to_string(text);
}

}  // namespace plumbline
