// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "report/records/calibration_record.h"
#include "report/records/comparison_record.h"
#include "report/records/perturbation_record.h"
#include "report/records/replay_record.h"
#include "report/records/study_record.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// Which record a run holds.
enum class RunKind { kCalibration, kTrajectory, kComparison, kPerturbation, kReplay, kStudy };

constexpr std::array<const char*, 6> enumWords(RunKind /*of*/) {
  return {"calibration", "trajectory", "comparison", "perturbation", "replay", "study"};
}

/// A run as it is listed.
struct RunSummary {
  std::int64_t id = 0;
  RunKind kind = RunKind::kCalibration;
  std::string name;
  std::string date;
  VerdictLevel verdict = VerdictLevel::kGood;
};

/// Records in one SQLite file: of each the document that its command writes and the samples, so
/// that every number comes back bit for bit. Besides, a run has rows that a study can query:
/// metrics (every number of the field list that has a unit), parameters (value, std, unit) and
/// findings; their column `stage` names the part of the run (a stage of a calibration, a case of a
/// perturbation study, a calibration of a comparison, a trajectory). See sql/schema.sql.
///
/// A store of an older version is read as it is and brought to this one by the first save(). A file
/// that is missing, is no SQLite file, belongs to another program, has a newer version or is
/// damaged ends in an InputError that names it.
class Store {
 public:
  explicit Store(std::filesystem::path path) : path_(std::move(path)) {}

  /// Adds a run and returns its id. A new file is written under a temporary name and renamed when
  /// complete; in a file that exists the run is one transaction. Nothing partial remains. Here and
  /// below, `Record` is one of those that RunKind names.
  template <class Record>
  std::int64_t save(const Record& record) const;

  /// The record of a run, or of the latest of its kind. InputError where the run is of another.
  template <class Record>
  Record load(std::optional<std::int64_t> run = std::nullopt) const;

  /// The JSON document of a run, as the command that made it wrote it into its folder.
  std::string document(std::int64_t run) const;

  /// The run of that number, or the latest of all.
  RunSummary summary(std::optional<std::int64_t> run = std::nullopt) const;

  /// All runs, oldest first.
  std::vector<RunSummary> runs() const;

 private:
  std::filesystem::path path_;
};

}  // namespace plumbline
