// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/workflow/trajectory_document.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

Json listOf(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json rowsOf(const Eigen::Matrix3d& R) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back(listOf(R.row(i).transpose()));
  return rows;
}

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
                    {"translation_m", statisticsOf(r.translation_m)},
                    {"rotation_deg", statisticsOf(r.rotation_deg)}});
  }
  return list;
}

}  // namespace

std::string trajectoryDocument(const TrajectoryEvaluation& evaluation) {
  const TrajectoryRun& run = evaluation.run;
  const Json json = {{"estimate", run.estimate},
                     {"truth", run.truth},
                     {"n", run.association.matches},
                     {"association", run.association.rule},
                     {"alignment", run.alignment.kind},
                     {"align_first", run.alignment.first_n},
                     {"scale", run.alignment.scale},
                     {"R", rowsOf(run.alignment.T_truth_estimate.R)},
                     {"t", listOf(run.alignment.T_truth_estimate.t)},
                     {"ate",
                      {{"translation_m", statisticsOf(run.ate_translation_m)},
                       {"rotation_deg", statisticsOf(run.ate_rotation_deg)}}},
                     {"rpe", rpeOf(run.rpe)},
                     {"coverage", run.coverage},
                     {"stamps", stampsOf(run.association)},
                     {"remarks", evaluation.remarks}};
  return json.dump(2) + "\n";
}

}  // namespace plumbline
