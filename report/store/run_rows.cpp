// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/run_rows.h"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "calibrator/base/error.h"
#include "report/store/database.h"

namespace plumbline::store_internal {

RunWriter::RunWriter(SQLite::Database& db, RunKind kind, const std::string& name,
                     const Provenance& p, const Verdict& verdict)
    : db_(db) {
  SQLite::Statement run(db,
                        "INSERT INTO runs (kind, name, version, command, input, input_hash, date, "
                        "verdict) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  runWith(run, toString(kind), name, p.version, p.command, p.input, p.input_hash, p.date,
          toString(verdict.level));
  run_ = db.getLastInsertRowid();
  SQLite::Statement option(
      db, "INSERT INTO options (run_id, position, name, value) VALUES (?, ?, ?, ?)");
  int position = 0;
  for (const auto& [key, value] : p.options) runWith(option, run_, position++, key, value);
  SQLite::Statement finding(
      db,
      "INSERT INTO findings (run_id, position, rule, level, evidence, advice, "
      "value, threshold, unit, subject) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  position = 0;
  for (const Finding& f : verdict.findings) {
    runWith(finding, run_, position++, f.rule, toString(f.level), f.evidence, f.advice, f.value,
            f.threshold, f.unit, toString(f.subject));
  }
}

void RunWriter::document(const std::string& json) {
  SQLite::Statement insert(db_, "INSERT INTO documents (run_id, json) VALUES (?, ?)");
  runWith(insert, run_, json);
}

void RunWriter::array(const std::string& name, const std::string& element,
                      const std::string& bytes) {
  SQLite::Statement insert(db_,
                           "INSERT INTO arrays (run_id, name, element, data) VALUES (?, ?, ?, ?)");
  insert.bind(1, run_);
  insert.bind(2, name);
  insert.bind(3, element);
  // The library's sizes are ints; SQLite's own limit of a blob is 1e9 bytes by default.
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw std::runtime_error("array '" + name + "' is larger than the store can hold");
  }
  insert.bindNoCopy(4, static_cast<const void*>(bytes.data()), static_cast<int>(bytes.size()));
  insert.exec();
}

void RunWriter::metrics(const std::vector<Metric>& metrics) {
  SQLite::Statement insert(
      db_, "INSERT INTO metrics (run_id, stage, name, unit, value) VALUES (?, ?, ?, ?, ?)");
  for (const Metric& m : metrics) runWith(insert, run_, m.stage, m.name, m.unit, m.value);
}

void RunWriter::parameters(const std::vector<StageParameters>& stages) {
  SQLite::Statement insert(db_,
                           "INSERT INTO parameters (run_id, stage, position, name, unit, value, "
                           "std, resample_std) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (const auto& [stage, parameters] : stages) {
    int position = 0;
    for (const ParameterEstimate& p : parameters) {
      // NaN is bound as NULL: no bootstrap was asked for.
      runWith(insert, run_, stage, position++, p.name, p.unit, p.value, p.std,
              p.resample_std.value_or(std::nan("")));
    }
  }
}

std::string RunReader::document() const {
  SQLite::Statement query(db_, "SELECT json FROM documents WHERE run_id = ?");
  query.bind(1, run_);
  if (!query.executeStep()) throw std::runtime_error("the run's document is missing");
  return query.getColumn(0).getString();
}

std::string RunReader::array(const std::string& name, const std::string& element) const {
  SQLite::Statement query(db_, "SELECT element, data FROM arrays WHERE run_id = ? AND name = ?");
  query.bind(1, run_);
  query.bind(2, name);
  if (!query.executeStep()) throw std::runtime_error("array '" + name + "' is missing");
  // Bytes carry no names: of other fields they would be read as something else.
  if (query.getColumn(0).getString() != element) {
    throw std::runtime_error("array '" + name + "' has elements of an unknown form");
  }
  const SQLite::Column data = query.getColumn(1);
  return std::string(static_cast<const char*>(data.getBlob()),
                     static_cast<std::size_t>(data.getBytes()));
}

std::vector<RunSummary> listRuns(SQLite::Database& db) {
  SQLite::Statement query(db, "SELECT id, kind, name, date, verdict FROM runs ORDER BY id");
  std::vector<RunSummary> runs;
  while (query.executeStep()) {
    runs.push_back({query.getColumn(0).getInt64(),
                    json_fields::enumOrThrow<RunKind>(query.getColumn(1).getString()),
                    query.getColumn(2).getString(), query.getColumn(3).getString(),
                    json_fields::enumOrThrow<VerdictLevel>(query.getColumn(4).getString())});
  }
  return runs;
}

RunSummary chooseRun(SQLite::Database& db, std::optional<std::int64_t> wanted,
                     std::optional<RunKind> kind, const std::string& path) {
  const std::vector<RunSummary> runs = listRuns(db);
  if (runs.empty())
    throw InputError(path, 0, "contains no run; run a command that writes one first");
  std::optional<RunSummary> chosen;
  for (const RunSummary& run : runs) {
    // Runs are in the order of their ids, so that the last one that fits is the latest.
    if (wanted ? run.id == *wanted : !kind || run.kind == *kind) chosen = run;
  }
  if (!chosen && wanted) {
    throw InputError(path, 0,
                     "contains no run " + std::to_string(*wanted) + "; its runs are " +
                         std::to_string(runs.front().id) + " to " + std::to_string(runs.back().id));
  }
  if (!chosen) throw InputError(path, 0, "contains no run of kind '" + toString(*kind) + "'");
  if (kind && chosen->kind != *kind) {
    throw InputError(path, 0,
                     "run " + std::to_string(chosen->id) + " is of kind '" +
                         toString(chosen->kind) + "', expected '" + toString(*kind) + "'");
  }
  return *chosen;
}

namespace {

/// The parameters of one calibration, those that it has.
std::vector<ParameterEstimate> estimatesOf(const ComparisonRecord& record, std::size_t k) {
  std::vector<ParameterEstimate> estimates;
  for (const ComparedParameter& p : record.parameters) {
    if (k >= p.values.size() || !p.values[k]) continue;
    std::optional<double> std;
    if (k < p.std.size()) std = p.std[k];
    estimates.push_back({p.name, *p.values[k], std.value_or(std::nan("")), p.unit, {}, {}, {}});
  }
  return estimates;
}

std::vector<ParameterEstimate> estimatesOf(const PerturbationRecord& record,
                                           const PerturbationCase& c, bool is_base) {
  std::vector<ParameterEstimate> estimates;
  for (std::size_t i = 0; i < c.values.size() && i < record.parameters.size(); ++i) {
    // Changes are counted in the base's deviations; a case states none of its own.
    const double std = is_base ? record.base_std[i] : std::nan("");
    estimates.push_back({record.parameters[i], c.values[i], std, record.units[i], {}, {}, {}});
  }
  return estimates;
}

/// Tells equal labels apart ("x", "x #2", ...): the stage is part of a key of the table.
std::string unique(const std::string& label, std::map<std::string, int>& seen) {
  const int n = ++seen[label];
  return n > 1 ? label + " #" + std::to_string(n) : label;
}

}  // namespace

std::vector<StageParameters> parametersOf(const CalibrationRecord& record) {
  return {{"camera", parameterEstimates(record, Stage::kCamera)},
          {"camera_imu", parameterEstimates(record, Stage::kCameraImu)}};
}

std::vector<StageParameters> parametersOf(const ComparisonRecord& record) {
  std::vector<StageParameters> stages;
  std::map<std::string, int> seen;
  for (std::size_t k = 0; k < record.calibrations.size(); ++k) {
    stages.push_back({unique(record.calibrations[k].label, seen), estimatesOf(record, k)});
  }
  return stages;
}

std::vector<StageParameters> parametersOf(const PerturbationRecord& record) {
  std::vector<StageParameters> stages{{"base", estimatesOf(record, record.base, true)}};
  std::map<std::string, int> seen;
  for (const PerturbationCase& c : record.cases) {
    stages.push_back({unique(partName(c), seen), estimatesOf(record, c, false)});
  }
  return stages;
}

std::vector<StageParameters> parametersOf(const StudyRecord& record) {
  std::vector<StageParameters> stages;
  std::map<std::string, int> seen;
  for (const StudySession& s : record.sessions) {
    // A session whose calibration failed has none.
    if (!s.estimates.empty()) stages.push_back({unique(s.name, seen), s.estimates});
  }
  return stages;
}

std::vector<StageParameters> parametersOf(const TrajectoryRecord& /*record*/) { return {}; }
std::vector<StageParameters> parametersOf(const ReplayRecord& /*record*/) { return {}; }

}  // namespace plumbline::store_internal
