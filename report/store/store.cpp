// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/store.h"

#include <array>
#include <functional>
#include <limits>

#include <SQLiteCpp/SQLiteCpp.h>

#include "calibrator/base/error.h"
#include "report/store/arrays.h"
#include "report/store/documents.h"
#include "report/store/metrics.h"
#include "report/store/sql.h"

namespace plumbline {
namespace {

namespace sql = embedded;
using namespace store_internal;

constexpr int kApplicationId = 0x504c4d42;  // "PLMB": tells our files from other SQLite files
constexpr int kSchemaVersion = 1;

int pragma(SQLite::Database& db, const char* name) {
  return db.execAndGet(std::string("PRAGMA ") + name).getInt();
}

/// Scripts that lift a file from version i to i + 1.
const std::array<const std::string& (*)(), kSchemaVersion> kMigrations = {&sql::schema_v1};

void migrate(SQLite::Database& db) {
  const int version = pragma(db, "user_version");
  if (version == kSchemaVersion) return;
  SQLite::Transaction transaction(db);
  for (int v = version; v < kSchemaVersion; ++v)
    db.exec(kMigrations[static_cast<std::size_t>(v)]());
  db.exec("PRAGMA application_id = " + std::to_string(kApplicationId));
  db.exec("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  transaction.commit();
}

/// Refuses a file that is not ours or newer than we are; throws SQLite's exception for damage.
void checkOwner(SQLite::Database& db, const std::string& path) {
  const int version = pragma(db, "user_version");
  if (pragma(db, "application_id") != kApplicationId || version < 1) {
    throw InputError(path, 0, "is an SQLite file of another program; name a store of Plumbline's");
  }
  if (version > kSchemaVersion) {
    throw InputError(path, 0,
                     "has store version " + std::to_string(version) +
                         ", this program knows up to " + std::to_string(kSchemaVersion) +
                         "; use a newer Plumbline");
  }
}

/// NULL for NaN, which SQLite cannot hold.
void bind(SQLite::Statement& statement, int column, double value) {
  if (value == value) {
    statement.bind(column, value);
  } else {
    statement.bind(column);
  }
}

double number(const SQLite::Column& column) {
  return column.isNull() ? std::numeric_limits<double>::quiet_NaN() : column.getDouble();
}

VerdictLevel level(const std::string& word) {
  const auto known = verdictLevelFrom(word);
  if (!known) throw std::runtime_error("unknown verdict '" + word + "'");
  return *known;
}

std::int64_t insertRun(SQLite::Database& db, const CalibrationRecord& record) {
  SQLite::Statement insert(db, sql::insert_run());
  const Provenance& p = record.provenance;
  int column = 0;
  for (const std::string& text : {record.name, p.version, p.command, p.input, p.input_hash, p.date,
                                  toString(record.verdict.level)}) {
    insert.bind(++column, text);
  }
  insert.exec();
  return db.getLastInsertRowid();
}

void insertOptions(SQLite::Database& db, std::int64_t run, const Provenance& provenance) {
  SQLite::Statement insert(db, sql::insert_option());
  int position = 0;
  for (const auto& [name, value] : provenance.options) {
    insert.reset();
    insert.bind(1, run);
    insert.bind(2, position++);
    insert.bind(3, name);
    insert.bind(4, value);
    insert.exec();
  }
}

void insertMetrics(SQLite::Database& db, std::int64_t run, const CalibrationRecord& record) {
  SQLite::Statement insert(db, sql::insert_metric());
  for (const Metric& metric : metricsOf(record)) {
    insert.reset();
    insert.bind(1, run);
    insert.bind(2, metric.stage);
    insert.bind(3, metric.name);
    insert.bind(4, metric.unit);
    bind(insert, 5, metric.value);
    insert.exec();
  }
}

void insertParameters(SQLite::Database& db, std::int64_t run, const std::string& stage,
                      const std::vector<ParameterEstimate>& parameters) {
  SQLite::Statement insert(db, sql::insert_parameter());
  int position = 0;
  for (const ParameterEstimate& p : parameters) {
    insert.reset();
    insert.bind(1, run);
    insert.bind(2, stage);
    insert.bind(3, position++);
    insert.bind(4, p.name);
    insert.bind(5, p.unit);
    bind(insert, 6, p.value);
    bind(insert, 7, p.std);
    bind(insert, 8, p.resample_std.value_or(std::numeric_limits<double>::quiet_NaN()));
    insert.exec();
  }
}

void insertFindings(SQLite::Database& db, std::int64_t run, const Verdict& verdict) {
  SQLite::Statement insert(db, sql::insert_finding());
  int position = 0;
  for (const Finding& finding : verdict.findings) {
    insert.reset();
    insert.bind(1, run);
    insert.bind(2, position++);
    insert.bind(3, finding.rule);
    insert.bind(4, toString(finding.level));
    insert.bind(5, finding.evidence);
    insert.bind(6, finding.advice);
    bind(insert, 7, finding.value);
    bind(insert, 8, finding.threshold);
    insert.bind(9, finding.unit);
    insert.exec();
  }
}

void insertDocument(SQLite::Database& db, std::int64_t run, const std::string& name,
                    const std::string& json) {
  SQLite::Statement insert(db, sql::insert_document());
  insert.bind(1, run);
  insert.bind(2, name);
  insert.bind(3, json);
  insert.exec();
}

void insertArray(SQLite::Database& db, std::int64_t run, const std::string& name,
                 const std::string& element, const std::string& bytes) {
  SQLite::Statement insert(db, sql::insert_array());
  insert.bind(1, run);
  insert.bind(2, name);
  insert.bind(3, element);
  insert.bindNoCopy(4, static_cast<const void*>(bytes.data()), static_cast<int>(bytes.size()));
  insert.exec();
}

void insertStages(SQLite::Database& db, std::int64_t run, const CalibrationRecord& record) {
  if (const auto& stage = record.camera) {
    insertDocument(db, run, "camera", cameraDocument(*stage));
    insertArray(db, run, "camera.frames", kFrameElement, packFrames(stage->frames));
    insertArray(db, run, "camera.T_FC0", kTransformElement, packTransforms(stage->T_FC0));
    insertArray(db, run, "camera.residuals", kResidualElement, packResiduals(stage->residuals));
  }
  if (const auto& stage = record.camera_imu) {
    insertDocument(db, run, "camera_imu", cameraImuDocument(*stage));
    insertArray(db, run, "camera_imu.frames", kFrameElement, packFrames(stage->frames));
    insertArray(db, run, "camera_imu.states", kStateElement, packStates(stage->states));
    insertArray(db, run, "camera_imu.residuals", kResidualElement, packResiduals(stage->residuals));
    insertArray(db, run, "camera_imu.intervals", kIntervalElement,
                packIntervals(stage->imu_residuals));
  }
}

std::int64_t insertRecord(SQLite::Database& db, const CalibrationRecord& record) {
  SQLite::Transaction transaction(db);
  const std::int64_t run = insertRun(db, record);
  insertOptions(db, run, record.provenance);
  insertMetrics(db, run, record);
  insertParameters(db, run, "camera", parameterEstimates(record, Stage::kCamera));
  insertParameters(db, run, "camera_imu", parameterEstimates(record, Stage::kCameraImu));
  insertFindings(db, run, record.verdict);
  insertDocument(db, run, "head", headDocument(record));
  insertStages(db, run, record);
  transaction.commit();
  return run;
}

std::optional<std::string> document(SQLite::Database& db, std::int64_t run,
                                    const std::string& name) {
  SQLite::Statement query(db, sql::select_document());
  query.bind(1, run);
  query.bind(2, name);
  if (!query.executeStep()) return std::nullopt;
  return query.getColumn(0).getString();
}

std::string array(SQLite::Database& db, std::int64_t run, const std::string& name,
                  const std::string& element) {
  SQLite::Statement query(db, sql::select_array());
  query.bind(1, run);
  query.bind(2, name);
  if (!query.executeStep()) throw std::runtime_error("array '" + name + "' is missing");
  if (query.getColumn(0).getString() != element) {
    throw std::runtime_error("array '" + name + "' has elements of an unknown form");
  }
  const SQLite::Column data = query.getColumn(1);
  return std::string(static_cast<const char*>(data.getBlob()),
                     static_cast<std::size_t>(data.getBytes()));
}

void readRun(SQLite::Database& db, std::int64_t run, CalibrationRecord& record) {
  SQLite::Statement query(db, sql::select_run());
  query.bind(1, run);
  if (!query.executeStep()) throw std::runtime_error("run " + std::to_string(run) + " is missing");
  Provenance& p = record.provenance;
  int column = 0;
  for (std::string* text :
       {&record.name, &p.version, &p.command, &p.input, &p.input_hash, &p.date}) {
    *text = query.getColumn(column++).getString();
  }
  record.verdict.level = level(query.getColumn(column).getString());
  SQLite::Statement options(db, sql::select_options());
  options.bind(1, run);
  while (options.executeStep()) {
    p.options.emplace_back(options.getColumn(0).getString(), options.getColumn(1).getString());
  }
}

void readFindings(SQLite::Database& db, std::int64_t run, Verdict& verdict) {
  SQLite::Statement query(db, sql::select_findings());
  query.bind(1, run);
  while (query.executeStep()) {
    Finding& finding = verdict.findings.emplace_back();
    finding.rule = query.getColumn(0).getString();
    finding.level = level(query.getColumn(1).getString());
    finding.evidence = query.getColumn(2).getString();
    finding.advice = query.getColumn(3).getString();
    finding.value = number(query.getColumn(4));
    finding.threshold = number(query.getColumn(5));
    finding.unit = query.getColumn(6).getString();
  }
}

void readStages(SQLite::Database& db, std::int64_t run, CalibrationRecord& record) {
  if (const auto json = document(db, run, "camera")) {
    CameraStageResult& stage = record.camera.emplace(readCameraDocument(*json));
    stage.frames = unpackFrames(array(db, run, "camera.frames", kFrameElement));
    stage.T_FC0 = unpackTransforms(array(db, run, "camera.T_FC0", kTransformElement));
    stage.residuals = unpackResiduals(array(db, run, "camera.residuals", kResidualElement));
  }
  if (const auto json = document(db, run, "camera_imu")) {
    CameraImuStageResult& stage = record.camera_imu.emplace(readCameraImuDocument(*json));
    stage.frames = unpackFrames(array(db, run, "camera_imu.frames", kFrameElement));
    stage.states = unpackStates(array(db, run, "camera_imu.states", kStateElement));
    stage.residuals = unpackResiduals(array(db, run, "camera_imu.residuals", kResidualElement));
    stage.imu_residuals = unpackIntervals(array(db, run, "camera_imu.intervals", kIntervalElement));
  }
}

std::vector<RunSummary> listRuns(SQLite::Database& db) {
  SQLite::Statement query(db, sql::select_runs());
  std::vector<RunSummary> runs;
  while (query.executeStep()) {
    runs.push_back({query.getColumn(0).getInt64(), query.getColumn(1).getString(),
                    query.getColumn(2).getString(), level(query.getColumn(3).getString())});
  }
  return runs;
}

std::int64_t chooseRun(const std::vector<RunSummary>& runs, std::optional<std::int64_t> wanted,
                       const std::string& path) {
  if (runs.empty()) throw InputError(path, 0, "holds no run; calibrate first");
  if (!wanted) return runs.back().id;
  for (const RunSummary& run : runs) {
    if (run.id == *wanted) return run.id;
  }
  throw InputError(path, 0,
                   "holds no run " + std::to_string(*wanted) + "; its runs are " +
                       std::to_string(runs.front().id) + " to " + std::to_string(runs.back().id));
}

/// Opens an existing store for reading and turns whatever goes wrong into an InputError.
template <class Work>
auto reading(const std::filesystem::path& path, const Work& work) {
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(path.string(), 0, "no such file; name a store that 'calibrate' wrote");
  }
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READONLY);
    checkOwner(db, path.string());
    return work(db);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // SQLite's, JSON's and the unpackers' complaints
    throw InputError(path.string(), 0,
                     std::string("is damaged or no store (") + error.what() +
                         "); expected a store that 'calibrate' wrote; calibrate again");
  }
}

std::int64_t writeInto(const std::filesystem::path& path, const CalibrationRecord& record,
                       bool existed) {
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    if (existed) checkOwner(db, path.string());
    db.exec("PRAGMA foreign_keys = ON");
    migrate(db);
    return insertRecord(db, record);
  } catch (const SQLite::Exception& error) {
    throw InputError(path.string(), 0,
                     std::string("cannot be written as a store (") + error.what() +
                         "); expected a new file or a store in a folder that can be written");
  }
}

}  // namespace

std::int64_t Store::save(const CalibrationRecord& record) const {
  if (std::filesystem::exists(path_)) return writeInto(path_, record, true);
  std::filesystem::path temporary = path_;
  temporary += ".partial";
  std::filesystem::remove(temporary);
  try {
    const std::int64_t run = writeInto(temporary, record, false);
    std::filesystem::rename(temporary, path_);
    return run;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

CalibrationRecord Store::loadCalibration(std::optional<std::int64_t> run) const {
  return reading(path_, [&](SQLite::Database& db) {
    const std::int64_t chosen = chooseRun(listRuns(db), run, path_.string());
    CalibrationRecord record;
    readRun(db, chosen, record);
    readFindings(db, chosen, record.verdict);
    const auto head = document(db, chosen, "head");
    if (!head) throw std::runtime_error("document 'head' is missing");
    readHeadDocument(*head, record);
    readStages(db, chosen, record);
    return record;
  });
}

std::vector<RunSummary> Store::runs() const {
  return reading(path_, [](SQLite::Database& db) { return listRuns(db); });
}

}  // namespace plumbline
