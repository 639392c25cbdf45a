// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <stdexcept>

#include "report/store/arrays.h"
#include "report/store/record_rows.h"
#include "report/store/shared_fields.h"

namespace plumbline {

template <class Archive>
void fields(Archive& a, SampleStatistics& s) {
  a("rmse", s.rmse);
  a("mean", s.mean);
  a("median", s.median);
  a("std", s.std);
  a("min", s.min);
  a("max", s.max);
  a("sse", s.sse);
  a("percentiles", s.percentiles);
  a("n", s.n);
}

template <class Archive>
void fields(Archive& a, AssociationRecord& r) {
  a("rule", r.rule);
  a("max_dt_s", r.max_dt_s);
  a("matches", r.matches);
  a("estimate_poses", r.estimate_poses);
  a("truth_poses", r.truth_poses);
  a("estimate_duplicates", r.estimate_duplicates);
  a("truth_duplicates", r.truth_duplicates);
  a("median_dt_s", r.median_dt_s);
  a("largest_estimate_gap_s", r.largest_estimate_gap_s);
  a("largest_truth_gap_s", r.largest_truth_gap_s);
  a("time_offset_s", r.time_offset_s);
  a("stamps_in_gaps", r.stamps_in_gaps);
}

template <class Archive>
void fields(Archive& a, AlignmentRecord& r) {
  a("kind", r.kind);
  a("first_n", r.first_n);
  a("scale", r.scale);
  a("T_truth_estimate", r.T_truth_estimate);
}

template <class Archive>
void fields(Archive& a, RelativeErrorRecord& r) {
  a("delta", r.delta);
  a("unit", r.unit);
  a("translation_m", r.translation_m);
  a("rotation_deg", r.rotation_deg);
  a.added("pairs", r.pairs);
}

template <class Archive>
void fields(Archive& a, ClockOffsetRecord& r) {
  a("offset_s", r.offset_s);
  a("std_s", r.std_s);
  a("correlation", r.correlation);
  a.added("magnitudes", r.magnitudes);
}

template <class Archive>
void fields(Archive& a, HandEyeRecord& r) {
  a("T_SM", r.T_SM);
  a("T_SM_std", r.T_SM_std);
  a.added("T_SM_covariance", r.T_SM_covariance);
  a("T_VW", r.T_VW);
  a("rms_translation_m", r.rms_translation_m);
  a("rms_rotation_rad", r.rms_rotation_rad);
}

template <class Archive>
void fields(Archive& a, NeesRecord& r) {
  a("part", r.part);
  a("dof", r.dof);
  a("mean", r.mean);
  a("lower", r.lower);
  a("upper", r.upper);
  a("confidence", r.confidence);
}

/// All but the samples, which are arrays.
template <class Archive>
void fields(Archive& a, TrajectoryRun& r) {
  a("sequence", r.sequence);
  a("calibration", r.calibration);
  a("run", r.run);
  a("estimate", r.estimate);
  a("truth", r.truth);
  a("status", r.status);
  a("problem", r.problem);
  a("remarks", r.remarks);
  a("coverage", r.coverage);
  a.added("starts_late_s", r.starts_late_s);
  a("association", r.association);
  a("alignment", r.alignment);
  a("ate_translation_m", r.ate_translation_m);
  a("ate_rotation_deg", r.ate_rotation_deg);
  a("rpe", r.rpe);
  a("clock_offset", r.clock_offset);
  a("hand_eye", r.hand_eye);
  a("nees", r.nees);
}

namespace store_internal {
namespace {

std::string arrayName(std::size_t run, const char* name) {
  return "trajectory." + std::to_string(run) + "." + name;
}

void writeSamples(RunWriter& out, std::size_t i, const TrajectoryRun& run) {
  out.array(arrayName(i, "t"), kTimeElement, packNumbers(run.t));
  out.array(arrayName(i, "truth_m"), kVector3Element, packVectors(run.truth_m));
  out.array(arrayName(i, "estimate_m"), kVector3Element, packVectors(run.estimate_m));
  out.array(arrayName(i, "error_m"), kNumberElement, packNumbers(run.error_m));
  out.array(arrayName(i, "error_deg"), kNumberElement, packNumbers(run.error_deg));
}

void readSamples(const RunReader& in, std::size_t i, TrajectoryRun& run) {
  run.t = unpackNumbers<TimeNs>(in.array(arrayName(i, "t"), kTimeElement));
  run.truth_m = unpackVectors<Eigen::Vector3d>(in.array(arrayName(i, "truth_m"), kVector3Element));
  run.estimate_m =
      unpackVectors<Eigen::Vector3d>(in.array(arrayName(i, "estimate_m"), kVector3Element));
  run.error_m = unpackNumbers<double>(in.array(arrayName(i, "error_m"), kNumberElement));
  run.error_deg = unpackNumbers<double>(in.array(arrayName(i, "error_deg"), kNumberElement));
}

void addStatistics(std::vector<Metric>& metrics, const std::string& stage, const std::string& name,
                   const std::string& unit, const SampleStatistics& s) {
  if (s.n == 0) return;
  metrics.push_back({stage, name + ".rmse", unit, s.rmse});
  metrics.push_back({stage, name + ".mean", unit, s.mean});
  metrics.push_back({stage, name + ".median", unit, s.median});
  metrics.push_back({stage, name + ".max", unit, s.max});
}

void addMetrics(std::vector<Metric>& metrics, const std::string& stage, const TrajectoryRun& run) {
  metrics.push_back({stage, "completed", "1", run.status == RunStatus::kComplete ? 1.0 : 0.0});
  metrics.push_back({stage, "failed", "1", run.status == RunStatus::kFailed ? 1.0 : 0.0});
  metrics.push_back({stage, "coverage", "1", run.coverage});
  metrics.push_back({stage, "matches", "1", static_cast<double>(run.association.matches)});
  addStatistics(metrics, stage, "ate_translation_m", "m", run.ate_translation_m);
  addStatistics(metrics, stage, "ate_rotation_deg", "deg", run.ate_rotation_deg);
}

}  // namespace

void writeTrajectories(RunWriter& out, const std::vector<TrajectoryRun>& runs) {
  std::vector<Metric> metrics;
  std::map<std::string, int> seen;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::string stage = runs[i].sequence + "/" + runs[i].calibration + "/" + runs[i].run;
    if (const int n = ++seen[stage]; n > 1) stage += " #" + std::to_string(n);
    addMetrics(metrics, stage, runs[i]);
    writeSamples(out, i, runs[i]);
  }
  out.metrics(metrics);
  out.document("trajectories", JsonWriter::toJson(runs).dump());
}

std::vector<TrajectoryRun> readTrajectories(const RunReader& in) {
  std::vector<TrajectoryRun> runs;
  JsonReader::fromJson(Json::parse(in.required("trajectories")), runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const int status = static_cast<int>(runs[i].status);
    if (status < 0 || status > static_cast<int>(RunStatus::kFailed)) {
      throw std::runtime_error("a trajectory has the unknown status " + std::to_string(status));
    }
    readSamples(in, i, runs[i]);
  }
  return runs;
}

void writeRecord(RunWriter& run, const TrajectoryRecord& record) {
  writeTrajectories(run, record.runs);
}

void readRecord(const RunReader& run, TrajectoryRecord& record) {
  record.runs = readTrajectories(run);
}

}  // namespace store_internal
}  // namespace plumbline
