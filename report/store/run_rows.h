// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "calibrator/fields/json_fields.h"
#include "report/store/store.h"

namespace plumbline::store_internal {

// The rows of a run, whatever its kind.

struct Metric {
  std::string stage;  ///< part of the run, e.g. "camera_imu", "imu-shift +10 ms"
  std::string name;   ///< the field's path within it, e.g. "seconds.solve"
  std::string unit;
  double value = 0;
};

/// The parameters of one part of a run.
struct StageParameters {
  std::string stage;
  std::vector<ParameterEstimate> parameters;
};

/// Of both stages; of every calibration; of the base and every case; of every session of a study;
/// other records have none.
std::vector<StageParameters> parametersOf(const CalibrationRecord& record);
std::vector<StageParameters> parametersOf(const ComparisonRecord& record);
std::vector<StageParameters> parametersOf(const PerturbationRecord& record);
std::vector<StageParameters> parametersOf(const TrajectoryRecord& record);
std::vector<StageParameters> parametersOf(const ReplayRecord& record);
std::vector<StageParameters> parametersOf(const StudyRecord& record);

/// A run being written.
class RunWriter {
 public:
  RunWriter(SQLite::Database& db, RunKind kind, const std::string& name,
            const Provenance& provenance, const Verdict& verdict);
  std::int64_t id() const { return run_; }
  void document(const std::string& json);
  /// `element` says what one element of the array holds; see packed_fields.h.
  void array(const std::string& name, const std::string& element, const std::string& bytes);
  void metrics(const std::vector<Metric>& metrics);
  void parameters(const std::vector<StageParameters>& stages);

 private:
  SQLite::Database& db_;
  std::int64_t run_ = 0;
};

/// A run being read. Throws std::runtime_error where something is missing or of an unknown form.
class RunReader {
 public:
  RunReader(SQLite::Database& db, std::int64_t run) : db_(db), run_(run) {}
  std::string document() const;
  std::string array(const std::string& name, const std::string& element) const;

 private:
  SQLite::Database& db_;
  std::int64_t run_;
};

std::vector<RunSummary> listRuns(SQLite::Database& db);

/// The run `wanted`, or the latest (of `kind`, where one is named). InputError where there is none,
/// or where the wanted one is of another kind.
RunSummary chooseRun(SQLite::Database& db, std::optional<std::int64_t> wanted,
                     std::optional<RunKind> kind, const std::string& path);

/// What the parts of a record that was read must agree on, and the sizes that pages are drawn from:
/// a file that was damaged or made up is refused here, rather than drawn for ever. Each throws
/// std::runtime_error.
void checkRecord(const CalibrationRecord& record);
void checkRecord(const PerturbationRecord& record);
void checkRecord(const ReplayRecord& record);
void checkRecord(const ComparisonRecord& record);
void checkRecord(const StudyRecord& record);
/// Its pages draw what fits together and leave the rest out.
inline void checkRecord(const TrajectoryRecord& /*record*/) {}

/// JSON of a document. Throws std::runtime_error where it is larger, or nested deeper, than any
/// that this program writes, and nlohmann's exceptions for what is no JSON.
Json parsedDocument(const std::string& text);

}  // namespace plumbline::store_internal
