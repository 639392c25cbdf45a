// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline {

/// A run as it is listed.
struct RunSummary {
  std::int64_t id = 0;
  std::string name;
  std::string date;
  VerdictLevel verdict = VerdictLevel::kGood;
};

/// Records in one SQLite file. Every number comes back bit for bit as it was saved. Besides the
/// record itself a run has rows that a study can query: metrics (name, unit, value), parameters
/// (value, std, unit) and findings.
///
/// A file that is missing, is no SQLite file, belongs to another program, was written by a newer
/// version or is damaged ends in an InputError that names it.
class Store {
 public:
  explicit Store(std::filesystem::path path) : path_(std::move(path)) {}

  /// Adds a run and returns its id. A new file is written under a temporary name and renamed when
  /// complete; in a file that exists the run is one transaction. Nothing partial remains.
  std::int64_t save(const CalibrationRecord& record) const;

  /// The record of a run, or of the latest.
  CalibrationRecord loadCalibration(std::optional<std::int64_t> run = std::nullopt) const;

  /// All runs, oldest first.
  std::vector<RunSummary> runs() const;

 private:
  std::filesystem::path path_;
};

}  // namespace plumbline
