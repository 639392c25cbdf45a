// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/store.h"

#include <array>

#include "report/store/database.h"
#include "report/store/record_rows.h"

namespace plumbline {
namespace {

using namespace store_internal;

constexpr std::array<const char*, 5> kKinds = {"calibration", "trajectory", "comparison",
                                               "perturbation", "replay"};

template <class Record>
std::int64_t saveAs(RunKind kind, const std::filesystem::path& path, const Record& record) {
  return writeStore(path, [&](SQLite::Database& db) {
    RunWriter run(db, {kind, record.name, record.provenance, record.verdict});
    writeRecord(run, record);
    return run.id();
  });
}

template <class Record>
Record loadAs(RunKind kind, const std::filesystem::path& path, std::optional<std::int64_t> wanted) {
  return readStore(path, [&](SQLite::Database& db) {
    const RunReader run(db, chooseRun(db, wanted, kind, path.string()).id);
    RunHead head = run.head();
    Record record;
    record.name = std::move(head.name);
    record.provenance = std::move(head.provenance);
    record.verdict = std::move(head.verdict);
    readRecord(run, record);
    return record;
  });
}

}  // namespace

std::string toString(RunKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::optional<RunKind> runKindFrom(const std::string& word) {
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (word == kKinds[i]) return static_cast<RunKind>(i);
  }
  return std::nullopt;
}

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

RunSummary Store::summary(std::optional<std::int64_t> run) const {
  return readStore(path_, [&](SQLite::Database& db) {
    return chooseRun(db, run, std::nullopt, path_.string());
  });
}

std::vector<RunSummary> Store::runs() const {
  return readStore(path_, [](SQLite::Database& db) { return listRuns(db); });
}

}  // namespace plumbline
