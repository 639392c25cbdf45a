// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/trajectory_document.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/results/json_values.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

Json statisticsOf(const SampleStatistics& s) {
  Json percentiles;
  for (std::size_t i = 0; i < kPercents.size(); ++i) {
    percentiles[fmt::format("{:g}", kPercents[i])] = s.percentiles[i];
  }
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
          {"std", s.std},   {"min", s.min},   {"max", s.max},
          {"sse", s.sse},   {"n", s.n},       {"percentiles", percentiles}};
}

Json stampsOf(const AssociationRecord& r) {
  return {{"max_dt_s", r.max_dt_s},
          {"time_offset_s", r.time_offset_s},
          {"estimate_poses", r.estimate_poses},
          {"truth_poses", r.truth_poses},
          {"estimate_duplicates", r.estimate_duplicates},
          {"truth_duplicates", r.truth_duplicates},
          {"median_dt_s", r.median_dt_s},
          {"largest_estimate_gap_s", r.largest_estimate_gap_s},
          {"largest_truth_gap_s", r.largest_truth_gap_s},
          {"stamps_in_gaps", r.stamps_in_gaps}};
}

Json rpeOf(const std::vector<RelativeErrorRecord>& records) {
  Json list = Json::array();
  for (const RelativeErrorRecord& r : records) {
    list.push_back({{"delta", r.delta},
                    {"unit", r.unit},
                    {"pairs", r.pairs},
                    {"translation_m", statisticsOf(r.translation_m)},
                    {"rotation_deg", statisticsOf(r.rotation_deg)}});
  }
  return list;
}

Json clockOf(const ClockOffsetRecord& r) {
  return {{"offset_s", r.offset_s},
          {"std_s", r.std_s},
          {"correlation", r.correlation},
          {"of", r.magnitudes ? "magnitudes" : "vectors"}};
}

Json handEyeOf(const HandEyeRecord& r) {
  return {{"T_SM", rowsJson(r.T_SM.matrix())},
          {"T_SM_std", vectorJson(r.T_SM_std)},
          {"T_SM_covariance", rowsJson(r.T_SM_covariance)},
          {"T_VW", rowsJson(r.T_VW.matrix())},
          {"rms_translation_m", r.rms_translation_m},
          {"rms_rotation_rad", r.rms_rotation_rad}};
}

Json neesOf(const std::vector<NeesRecord>& records) {
  Json list = Json::array();
  for (const NeesRecord& r : records) {
    list.push_back({{"part", r.part},
                    {"dof", r.dof},
                    {"mean", r.mean},
                    {"lower", r.lower},
                    {"upper", r.upper},
                    {"confidence", r.confidence}});
  }
  return list;
}

}  // namespace

nlohmann::ordered_json trajectoryRunJson(const TrajectoryRun& run) {
  Json json = {{"estimate", run.estimate}, {"truth", run.truth}};
  if (run.status != RunStatus::kFailed) {
    json["n"] = run.association.matches;
    json["association"] = run.association.rule;
    json["alignment"] = run.alignment.kind;
    json["align_first"] = run.alignment.first_n;
    json["scale"] = run.alignment.scale;
    json["R"] = rowsJson(run.alignment.T_truth_estimate.R);
    json["t"] = vectorJson(run.alignment.T_truth_estimate.t);
    json["ate"] = {{"translation_m", statisticsOf(run.ate_translation_m)},
                   {"rotation_deg", statisticsOf(run.ate_rotation_deg)}};
    json["rpe"] = rpeOf(run.rpe);
    json["coverage"] = run.coverage;
    json["starts_late_s"] = run.starts_late_s;
    json["stamps"] = stampsOf(run.association);
  }
  if (run.clock_offset) json["clock_offset"] = clockOf(*run.clock_offset);
  if (run.hand_eye) json["hand_eye"] = handEyeOf(*run.hand_eye);
  if (!run.nees.empty()) json["nees"] = neesOf(run.nees);
  json["remarks"] = run.remarks;
  return json;
}

std::string trajectoryDocument(const TrajectoryEvaluation& evaluation) {
  return trajectoryRunJson(evaluation.run).dump(2) + "\n";
}

}  // namespace plumbline
