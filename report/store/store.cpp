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
  explicit ArrayWriter(RunWriter& run) : out(run) {}
  RunWriter& out;

  template <class T>
  void array(const char* name, const std::vector<T>& values, const char* /*text*/) {
    out.array(under(name), describe<T>(), packArray(values));
  }
};

struct ArrayReader : PathSink {
  explicit ArrayReader(const RunReader& run) : in(run) {}
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
  template <class T>
  void array(const char* /*name*/, const T& /*values*/, const char* /*text*/) {}
};

template <class Record>
std::int64_t saveAs(RunKind kind, const std::filesystem::path& path, const Record& record) {
  return writeStore(path, [&](SQLite::Database& db) {
    RunWriter run(db, kind, record.name, record.provenance, record.verdict);
    // Document and arrays bring the record back; metrics and parameters are for queries alone.
    run.document(documentOf(record));
    ArrayWriter arrays(run);
    walkFields(arrays, record);
    MetricSink sink;
    walkFields(sink, record);
    run.metrics(sink.metrics);
    run.parameters(parametersOf(record));
    return run.id();
  });
}

template <class Record>
Record loadAs(RunKind kind, const std::filesystem::path& path, std::optional<std::int64_t> wanted) {
  return readStore(path, [&](SQLite::Database& db) {
    const RunReader run(db, chooseRun(db, wanted, kind, path.string()).id);
    Record record;
    // First the document, whose optional parts say which arrays there are.
    fromJson(parsedDocument(run.document()), record);
    ArrayReader arrays(run);
    walkFields(arrays, record);
    // Last, since what must agree lies partly in the document and partly in the arrays.
    checkRecord(record);
    return record;
  });
}

}  // namespace

std::int64_t Store::save(const CalibrationRecord& record) const {
  return saveAs(RunKind::kCalibration, path_, record);
}

std::int64_t Store::save(const TrajectoryRecord& record) const {
  return saveAs(RunKind::kTrajectory, path_, record);
}

std::int64_t Store::save(const ComparisonRecord& record) const {
  return saveAs(RunKind::kComparison, path_, record);
}

std::int64_t Store::save(const PerturbationRecord& record) const {
  return saveAs(RunKind::kPerturbation, path_, record);
}

std::int64_t Store::save(const ReplayRecord& record) const {
  return saveAs(RunKind::kReplay, path_, record);
}

std::int64_t Store::save(const StudyRecord& record) const {
  return saveAs(RunKind::kStudy, path_, record);
}

CalibrationRecord Store::loadCalibration(std::optional<std::int64_t> run) const {
  return loadAs<CalibrationRecord>(RunKind::kCalibration, path_, run);
}

TrajectoryRecord Store::loadTrajectory(std::optional<std::int64_t> run) const {
  return loadAs<TrajectoryRecord>(RunKind::kTrajectory, path_, run);
}

ComparisonRecord Store::loadComparison(std::optional<std::int64_t> run) const {
  return loadAs<ComparisonRecord>(RunKind::kComparison, path_, run);
}

PerturbationRecord Store::loadPerturbation(std::optional<std::int64_t> run) const {
  return loadAs<PerturbationRecord>(RunKind::kPerturbation, path_, run);
}

ReplayRecord Store::loadReplay(std::optional<std::int64_t> run) const {
  return loadAs<ReplayRecord>(RunKind::kReplay, path_, run);
}

StudyRecord Store::loadStudy(std::optional<std::int64_t> run) const {
  return loadAs<StudyRecord>(RunKind::kStudy, path_, run);
}

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
