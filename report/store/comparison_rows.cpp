// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <map>
#include <stdexcept>

#include "report/store/arrays.h"
#include "report/store/record_rows.h"
#include "report/store/shared_fields.h"

namespace plumbline {

template <class Archive>
void fields(Archive& a, Finding& f) {
  a("rule", f.rule);
  a("level", f.level);
  a("evidence", f.evidence);
  a("advice", f.advice);
  a("value", f.value);
  a("threshold", f.threshold);
  a("unit", f.unit);
}

template <class Archive>
void fields(Archive& a, Calibration& c) {
  a("cameras", c.cameras);
  a("imu", c.imu);
}

template <class Archive>
void fields(Archive& a, ComparedCalibration& c) {
  a("label", c.label);
  a("file", c.file);
  a("tool", c.tool);
  a("calibration", c.calibration);
  a("lint", c.lint);
}

template <class Archive>
void fields(Archive& a, ComparedParameter& p) {
  a("name", p.name);
  a("unit", p.unit);
  a("values", p.values);
  a("std", p.std);
  a("difference", p.difference);
  a("significance", p.significance);
}

/// All but the cells, which are arrays.
template <class Archive>
void fields(Archive& a, ImageMap& m) {
  a("camera", m.camera);
  a("label", m.label);
  a("method", m.method);
  a("range_m", m.range_m);
  a("columns", m.columns);
  a("rows", m.rows);
  a("width", m.width);
  a("height", m.height);
  a("implied", m.implied);
}

template <class Archive>
void fields(Archive& a, OffsetSummary& o) {
  a("label", o.label);
  a("time_offset_s", o.time_offset_s);
  a("std_s", o.std_s);
  a("per_camera_s", o.per_camera_s);
}

template <class Archive>
void fields(Archive& a, PairedPrediction& p) {
  a("label", p.label);
  a("camera", p.camera);
  a("views", p.views);
  a("difference_px2", p.difference_px2);
  a("std_px2", p.std_px2);
}

/// All but the trajectories, which have a document of their own.
template <class Archive>
void fields(Archive& a, ComparisonRecord& r) {
  a("assumptions", r.assumptions);
  a("calibrations", r.calibrations);
  a("parameters", r.parameters);
  a("scores", r.scores);
  a("paired", r.paired);
  a("differences", r.differences);
  a("uncertainties", r.uncertainties);
  a("offsets", r.offsets);
}

namespace store_internal {
namespace {

void writeMaps(RunWriter& run, const std::string& name, const std::vector<ImageMap>& maps) {
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::string prefix = name + "." + std::to_string(i) + ".";
    run.array(prefix + "values", kNumberElement, packNumbers(maps[i].values));
    run.array(prefix + "vectors", kVector2Element, packVectors(maps[i].vectors));
  }
}

void readMaps(const RunReader& run, const std::string& name, std::vector<ImageMap>& maps) {
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::string prefix = name + "." + std::to_string(i) + ".";
    maps[i].values = unpackNumbers<double>(run.array(prefix + "values", kNumberElement));
    maps[i].vectors =
        unpackVectors<Eigen::Vector2d>(run.array(prefix + "vectors", kVector2Element));
  }
}

/// The parameters of one calibration, those that it has.
std::vector<ParameterEstimate> estimatesOf(const ComparisonRecord& record, std::size_t k) {
  std::vector<ParameterEstimate> estimates;
  for (const ComparedParameter& p : record.parameters) {
    if (k >= p.values.size() || !p.values[k]) continue;
    ParameterEstimate& e = estimates.emplace_back();
    e.name = p.name;
    e.unit = p.unit;
    e.value = *p.values[k];
    e.std = k < p.std.size() ? p.std[k].value_or(std::numeric_limits<double>::quiet_NaN())
                             : std::numeric_limits<double>::quiet_NaN();
  }
  return estimates;
}

void checkLevels(const ComparisonRecord& record) {
  for (const ComparedCalibration& c : record.calibrations) {
    for (const Finding& f : c.lint) {
      const int level = static_cast<int>(f.level);
      if (level < 0 || level > static_cast<int>(VerdictLevel::kBad)) {
        throw std::runtime_error("a finding has the unknown level " + std::to_string(level));
      }
    }
  }
}

}  // namespace

void writeRecord(RunWriter& run, const ComparisonRecord& record) {
  run.metrics(metricsOf(record.scores));
  std::map<std::string, int> seen;
  for (std::size_t k = 0; k < record.calibrations.size(); ++k) {
    std::string stage = record.calibrations[k].label;
    if (const int n = ++seen[stage]; n > 1) stage += " #" + std::to_string(n);
    run.parameters(stage, estimatesOf(record, k));
  }
  run.document("comparison", JsonWriter::toJson(record).dump());
  writeMaps(run, "difference", record.differences);
  writeMaps(run, "uncertainty", record.uncertainties);
  writeTrajectories(run, record.runs);
}

void readRecord(const RunReader& run, ComparisonRecord& record) {
  JsonReader::fromJson(Json::parse(run.required("comparison")), record);
  checkLevels(record);
  readMaps(run, "difference", record.differences);
  readMaps(run, "uncertainty", record.uncertainties);
  record.runs = readTrajectories(run);
}

}  // namespace store_internal
}  // namespace plumbline
