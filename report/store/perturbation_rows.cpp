// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <sstream>

#include "report/store/record_rows.h"
#include "report/store/shared_fields.h"

namespace plumbline {

template <class Archive>
void fields(Archive& a, PerturbationCase& c) {
  a("kind", c.kind);
  a("amount", c.amount);
  a("unit", c.unit);
  a("seed", c.seed);
  a("problem", c.problem);
  a("rmse_px", c.rmse_px);
  a("frames", c.frames);
  a("iterations", c.iterations);
  a("time_offset_s", c.time_offset_s);
  a("time_offset_std_s", c.time_offset_std_s);
  a("offset_error_s", c.offset_error_s);
  a("values", c.values);
  a("changes", c.changes);
  a("changes_sigma", c.changes_sigma);
}

template <class Archive>
void fields(Archive& a, PerturbationRecord& r) {
  a("assumptions", r.assumptions);
  a("parameters", r.parameters);
  a("units", r.units);
  a("base_std", r.base_std);
  a("offset_bound_s", r.offset_bound_s);
  a("base", r.base);
  a("cases", r.cases);
}

namespace store_internal {
namespace {

/// "imu-shift +10 ms", "corner-noise +0.1 px seed 2"; "base" for the base.
std::string stageOf(const PerturbationCase& c) {
  if (c.unit.empty()) return c.kind;
  std::ostringstream text;
  text << c.kind << ' ' << std::showpos << c.amount << std::noshowpos << ' ' << c.unit;
  if (c.seed != 0) text << " seed " << c.seed;
  return text.str();
}

void addMetrics(std::vector<Metric>& metrics, const std::string& stage, const PerturbationCase& c) {
  const bool solved = c.problem.empty();
  metrics.push_back({stage, "solved", "1", solved ? 1.0 : 0.0});
  metrics.push_back({stage, "amount", c.unit, c.amount});
  if (!solved) return;
  metrics.push_back({stage, "rmse_px", "px", c.rmse_px});
  metrics.push_back({stage, "frames", "1", static_cast<double>(c.frames)});
  metrics.push_back({stage, "iterations", "1", static_cast<double>(c.iterations)});
  if (!c.time_offset_std_s) return;
  metrics.push_back({stage, "time_offset_s", "s", c.time_offset_s});
  metrics.push_back({stage, "time_offset_std_s", "s", *c.time_offset_std_s});
  metrics.push_back({stage, "offset_error_s", "s", c.offset_error_s});
}

std::vector<ParameterEstimate> estimatesOf(const PerturbationRecord& record,
                                           const PerturbationCase& c, bool is_base) {
  std::vector<ParameterEstimate> estimates;
  for (std::size_t i = 0; i < c.values.size() && i < record.parameters.size(); ++i) {
    ParameterEstimate& p = estimates.emplace_back();
    p.name = record.parameters[i];
    p.unit = i < record.units.size() ? record.units[i] : "";
    p.value = c.values[i];
    p.std = is_base && i < record.base_std.size() ? record.base_std[i]
                                                  : std::numeric_limits<double>::quiet_NaN();
  }
  return estimates;
}

}  // namespace

void writeRecord(RunWriter& run, const PerturbationRecord& record) {
  std::vector<Metric> metrics;
  addMetrics(metrics, "base", record.base);
  run.parameters("base", estimatesOf(record, record.base, true));
  std::map<std::string, int> seen;
  for (const PerturbationCase& c : record.cases) {
    std::string stage = stageOf(c);
    if (const int n = ++seen[stage]; n > 1) stage += " #" + std::to_string(n);
    addMetrics(metrics, stage, c);
    run.parameters(stage, estimatesOf(record, c, false));
  }
  run.metrics(metrics);
  run.document("perturbation", JsonWriter::toJson(record).dump());
}

void readRecord(const RunReader& run, PerturbationRecord& record) {
  JsonReader::fromJson(Json::parse(run.required("perturbation")), record);
}

}  // namespace store_internal
}  // namespace plumbline
