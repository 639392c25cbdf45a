// SPDX-License-Identifier: BSD-3-Clause
// Records: their JSON documents, and the store that keeps them.
#include <SQLiteCpp/SQLiteCpp.h>

#include "calibrator/base/error.h"
#include "calibrator/fields/json_fields.h"
#include "report/records/documents.h"
#include "report/store/store.h"
#include "tests/fuzz/parser.h"
#include "tests/report/synthetic_record.h"
#include "tests/report/synthetic_replay.h"

namespace plumbline::fuzz {
namespace {

ComparisonRecord smallComparison() {
  ComparisonRecord record;
  record.calibrations.resize(2);
  record.parameters.resize(1);
  record.scores.resize(1);
  record.differences.resize(1);
  return record;
}

PerturbationRecord smallPerturbation() {
  PerturbationRecord record;
  record.cases.resize(2);
  return record;
}

TrajectoryRecord smallTrajectories() {
  TrajectoryRecord record;
  record.runs.resize(2);
  return record;
}

CalibrationRecord smallCalibration() {
  return test::syntheticRecord({.frames = 2, .tags_seen = 1});
}

ReplayRecord smallReplay() { return test::syntheticReplay({.frames = 4, .columns = 1}); }

/// Lists cut to two elements, but for vectors and matrices of fixed sizes: small seeds are what a
/// fuzzer makes most of.
Json shortened(const Json& json) {
  constexpr std::size_t kLargestFixed = 16;
  if (!json.is_structured()) return json;
  const bool list = json.is_array() &&
                    (json.size() > kLargestFixed || (!json.empty() && json.front().is_object()));
  Json all = json.is_array() ? Json::array() : Json::object();
  for (const auto& [key, value] : json.items()) {
    if (list && all.size() == 2) break;
    json.is_array() ? all.push_back(shortened(value)) : void(all[key] = shortened(value));
  }
  return all;
}

template <class Record>
std::string shortDocument(const Record& record) {
  return shortened(Json::parse(documentOf(record))).dump();
}

template <class Record>
Record fromDocument(const Json& document) {
  Record record;
  fromJson(document, record);
  return record;
}

template <class Record>
bool isDocumentOf(const Json& document, const std::string& path) {
  Record record;
  try {
    record = fromDocument<Record>(document);
  } catch (const std::exception&) {
    return false;
  }
  expectStable(
      path, record, [](const Record& r) { return documentOf(r); },
      [](const std::string& copy) { return fromDocument<Record>(Json::parse(readBytes(copy))); });
  return true;
}

void loadRun(const Store& store, const RunSummary& run) {
  switch (run.kind) {
    case RunKind::kCalibration:
      documentOf(store.load<CalibrationRecord>(run.id));
      return;
    case RunKind::kTrajectory:
      documentOf(store.load<TrajectoryRecord>(run.id));
      return;
    case RunKind::kComparison:
      documentOf(store.load<ComparisonRecord>(run.id));
      return;
    case RunKind::kPerturbation:
      documentOf(store.load<PerturbationRecord>(run.id));
      return;
    case RunKind::kReplay:
      documentOf(store.load<ReplayRecord>(run.id));
      return;
    case RunKind::kStudy:
      documentOf(store.load<StudyRecord>(run.id));
      return;
  }
}

}  // namespace

Parser document() {
  const auto read = [](const std::string& path) {
    Json json;
    try {  // what the store makes an InputError is one here
      json = Json::parse(readBytes(path));
    } catch (const Json::exception&) {
      throw InputError(path, 0, "is not JSON");
    }
    const bool known = static_cast<int>(isDocumentOf<CalibrationRecord>(json, path)) +
                           static_cast<int>(isDocumentOf<TrajectoryRecord>(json, path)) +
                           static_cast<int>(isDocumentOf<ComparisonRecord>(json, path)) +
                           static_cast<int>(isDocumentOf<PerturbationRecord>(json, path)) +
                           static_cast<int>(isDocumentOf<ReplayRecord>(json, path)) +
                           static_cast<int>(isDocumentOf<StudyRecord>(json, path)) >
                       0;
    if (!known) throw InputError(path, 0, "is no document of a record");
  };
  const auto seeds = [] {
    return std::vector<std::string>{
        shortDocument(smallCalibration()), shortDocument(smallTrajectories()),
        shortDocument(smallComparison()), shortDocument(smallPerturbation()),
        shortDocument(smallReplay())};
  };
  return {read, seeds, {}};
}

Parser store() {
  const auto read = [](const std::string& path) {
    const Store store(path);
    for (const RunSummary& run : store.runs()) loadRun(store, run);
  };
  const auto seeds = [] {
    std::vector<std::string> seeds;
    const auto add = [&](const auto& record) {
      const Scratch scratch;
      const std::string path = scratch.path("runs.sqlite");
      Store(path).save(record);
      // In the smallest pages, of which there are enough to change.
      SQLite::Database(path, SQLite::OPEN_READWRITE).exec("PRAGMA page_size = 512; VACUUM");
      seeds.push_back(readBytes(path));
    };
    add(smallCalibration());
    add(smallTrajectories());
    add(smallComparison());
    add(smallPerturbation());
    add(smallReplay());
    return seeds;
  };
  return {read, seeds, {}, "runs.sqlite"};
}

}  // namespace plumbline::fuzz
