// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/store.h"

#include <map>

#include "calibrator/fields/json_fields.h"
#include "report/records/documents.h"
#include "report/records/field_walker.h"
#include "report/store/database.h"
#include "report/store/packed_fields.h"
#include "report/store/run_rows.h"

namespace plumbline {
namespace {

using namespace store_internal;

/// Where a walk stands. Elements of lists go by their position.
struct PathSink {
  static constexpr bool kAll = false;
  std::vector<std::string> path;

  template <class T>
  bool field(const char* /*name*/, const std::string& /*unit*/, const char* /*text*/) {
    return true;
  }
  void number(const char* /*name*/, const std::string& /*unit*/, double /*value*/) {}
  void enter(const char* name) { path.emplace_back(name); }
  void leave() { path.pop_back(); }
  void element(std::size_t index, const std::string& /*label*/) {
    path.push_back(std::to_string(index));
  }
  std::string under(const char* name, std::size_t from = 0) const {
    std::string text;
    for (std::size_t i = from; i < path.size(); ++i) text += path[i] + ".";
    return text + name;
  }
};

struct ArrayWriter : PathSink {
  RunWriter& out;

  template <class T>
  void array(const char* name, const std::vector<T>& values, const char* /*text*/) {
    out.array(under(name), describe<T>(), packArray(values));
  }
};

struct ArrayReader : PathSink {
  const RunReader& in;

  template <class T>
  void array(const char* name, std::vector<T>& values, const char* /*text*/) {
    values = unpackArray<T>(in.array(under(name), describe<T>()));
  }
};

/// Every number that has a unit. Its stage is the stage of a calibration, the label of an element
/// of a list, or the name of a struct at the record's top.
struct MetricSink : PathSink {
  std::vector<Metric> metrics;
  std::map<std::string, int> seen;

  bool in_list = false;

  void enter(const char* name) {
    // A field at the top begins; whether it is a list of structs shows with the first of them.
    if (path.empty()) in_list = false;
    PathSink::enter(name);
  }
  void element(std::size_t index, const std::string& label) {
    // Lists within a stage: their elements are part of the metric's name.
    if (path.size() > 1) return PathSink::element(index, label);
    in_list = true;
    // Two elements of one label would be one stage to whoever queries: the second is "LABEL #2".
    const int n = ++seen[path.back() + "/" + label];
    path.push_back(n > 1 ? label + " #" + std::to_string(n) : label);
  }
  void number(const char* name, const std::string& unit, double value) {
    // A figure at the record's top belongs to no part of the run.
    if (path.empty()) return metrics.push_back({"", name, unit, value});
    // Below a list or `stages` the second name tells the part of the run, else the first does.
    const std::size_t stage = path.size() > 1 && (in_list || path[0] == "stages") ? 1 : 0;
    metrics.push_back({path[stage], under(name, stage + 1), unit, value});
  }
  void array(const char* /*name*/, const auto& /*values*/, const char* /*text*/) {}
};

constexpr RunKind kindOf(const CalibrationRecord& /*of*/) { return RunKind::kCalibration; }
constexpr RunKind kindOf(const TrajectoryRecord& /*of*/) { return RunKind::kTrajectory; }
constexpr RunKind kindOf(const ComparisonRecord& /*of*/) { return RunKind::kComparison; }
constexpr RunKind kindOf(const PerturbationRecord& /*of*/) { return RunKind::kPerturbation; }
constexpr RunKind kindOf(const ReplayRecord& /*of*/) { return RunKind::kReplay; }
constexpr RunKind kindOf(const StudyRecord& /*of*/) { return RunKind::kStudy; }

}  // namespace

template <class Record>
std::int64_t Store::save(const Record& record) const {
  return writeStore(path_, [&](SQLite::Database& db) {
    RunWriter run(db, kindOf(record), record.name, record.provenance, record.verdict);
    // Document and arrays bring the record back; metrics and parameters are for queries alone.
    run.document(documentOf(record));
    ArrayWriter arrays{{}, run};
    walkFields(arrays, record);
    MetricSink sink;
    walkFields(sink, record);
    run.metrics(sink.metrics);
    run.parameters(parametersOf(record));
    return run.id();
  });
}

template std::int64_t Store::save(const CalibrationRecord& record) const;
template std::int64_t Store::save(const TrajectoryRecord& record) const;
template std::int64_t Store::save(const ComparisonRecord& record) const;
template std::int64_t Store::save(const PerturbationRecord& record) const;
template std::int64_t Store::save(const ReplayRecord& record) const;
template std::int64_t Store::save(const StudyRecord& record) const;

template <class Record>
Record Store::load(std::optional<std::int64_t> wanted) const {
  return readStore(path_, [&](SQLite::Database& db) {
    Record record;
    const RunReader run(db, chooseRun(db, wanted, kindOf(record), path_.string()).id);
    // First the document, whose optional parts say which arrays there are.
    fromJson(parsedDocument(run.document()), record);
    ArrayReader arrays{{}, run};
    walkFields(arrays, record);
    // Last, since what must agree lies partly in the document and partly in the arrays.
    checkRecord(record);
    return record;
  });
}

template CalibrationRecord Store::load(std::optional<std::int64_t> wanted) const;
template TrajectoryRecord Store::load(std::optional<std::int64_t> wanted) const;
template ComparisonRecord Store::load(std::optional<std::int64_t> wanted) const;
template PerturbationRecord Store::load(std::optional<std::int64_t> wanted) const;
template ReplayRecord Store::load(std::optional<std::int64_t> wanted) const;
template StudyRecord Store::load(std::optional<std::int64_t> wanted) const;

std::string Store::document(std::int64_t run) const {
  return readStore(path_, [&](SQLite::Database& db) {
    return RunReader(db, chooseRun(db, run, std::nullopt, path_.string()).id).document();
  });
}

RunSummary Store::summary(std::optional<std::int64_t> run) const {
  return readStore(path_, [&](SQLite::Database& db) {
    return chooseRun(db, run, std::nullopt, path_.string());
  });
}

std::vector<RunSummary> Store::runs() const {
  return readStore(path_, [](SQLite::Database& db) { return listRuns(db); });
}

}  // namespace plumbline
