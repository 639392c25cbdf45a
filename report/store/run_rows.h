// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "report/records/calibration_record.h"
#include "report/store/metrics.h"
#include "report/store/store.h"

namespace plumbline::store_internal {

// The rows that runs of every kind have. Reading throws std::runtime_error where something is
// missing or of an unknown form.

/// What stands in a run's own row, its options and its findings.
struct RunHead {
  RunKind kind = RunKind::kCalibration;
  std::string name;
  Provenance provenance;
  Verdict verdict;
};

/// A run being written.
class RunWriter {
 public:
  RunWriter(SQLite::Database& db, const RunHead& head);
  std::int64_t id() const { return run_; }
  void metrics(const std::vector<Metric>& metrics);
  void parameters(const std::string& stage, const std::vector<ParameterEstimate>& parameters);
  void document(const std::string& name, const std::string& json);
  /// `element` says what one element of the array holds; see arrays.h.
  void array(const std::string& name, const std::string& element, const std::string& bytes);

 private:
  void options(const Provenance& provenance);
  void findings(const Verdict& verdict);

  SQLite::Database& db_;
  std::int64_t run_ = 0;
};

/// A run being read.
class RunReader {
 public:
  RunReader(SQLite::Database& db, std::int64_t run) : db_(db), run_(run) {}
  RunHead head() const;
  std::optional<std::string> document(const std::string& name) const;
  std::string required(const std::string& document_name) const;
  std::string array(const std::string& name, const std::string& element) const;

 private:
  Verdict findings(VerdictLevel level) const;

  SQLite::Database& db_;
  std::int64_t run_;
};

std::vector<RunSummary> listRuns(SQLite::Database& db);

/// The run `wanted`, or the latest (of `kind`, where one is named). InputError where there is none,
/// or where the wanted one is of another kind.
RunSummary chooseRun(SQLite::Database& db, std::optional<std::int64_t> wanted,
                     std::optional<RunKind> kind, const std::string& path);

}  // namespace plumbline::store_internal
