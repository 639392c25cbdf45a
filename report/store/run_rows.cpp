// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/run_rows.h"

#include <limits>
#include <stdexcept>

#include "generated/report/embedded.h"
#include "report/store/database.h"

namespace plumbline::store_internal {
namespace {

namespace sql = embedded;

VerdictLevel levelFrom(const std::string& word) {
  const auto known = verdictLevelFrom(word);
  if (!known) throw std::runtime_error("unknown verdict '" + word + "'");
  return *known;
}

RunKind kindFrom(const std::string& word) {
  const auto known = runKindFrom(word);
  if (!known) throw std::runtime_error("unknown kind of run '" + word + "'");
  return *known;
}

std::int64_t insertRun(SQLite::Database& db, const RunHead& head) {
  SQLite::Statement insert(db, sql::insert_run());
  const Provenance& p = head.provenance;
  int column = 0;
  for (const std::string& text : {toString(head.kind), head.name, p.version, p.command, p.input,
                                  p.input_hash, p.date, toString(head.verdict.level)}) {
    insert.bind(++column, text);
  }
  insert.exec();
  return db.getLastInsertRowid();
}

}  // namespace

RunWriter::RunWriter(SQLite::Database& db, const RunHead& head)
    : db_(db), run_(insertRun(db, head)) {
  options(head.provenance);
  findings(head.verdict);
}

void RunWriter::options(const Provenance& provenance) {
  SQLite::Statement insert(db_, sql::insert_option());
  int position = 0;
  for (const auto& [name, value] : provenance.options) {
    insert.reset();
    insert.bind(1, run_);
    insert.bind(2, position++);
    insert.bind(3, name);
    insert.bind(4, value);
    insert.exec();
  }
}

void RunWriter::findings(const Verdict& verdict) {
  SQLite::Statement insert(db_, sql::insert_finding());
  int position = 0;
  for (const Finding& finding : verdict.findings) {
    insert.reset();
    insert.bind(1, run_);
    insert.bind(2, position++);
    insert.bind(3, finding.rule);
    insert.bind(4, toString(finding.level));
    insert.bind(5, finding.evidence);
    insert.bind(6, finding.advice);
    bindNumber(insert, 7, finding.value);
    bindNumber(insert, 8, finding.threshold);
    insert.bind(9, finding.unit);
    insert.exec();
  }
}

void RunWriter::metrics(const std::vector<Metric>& metrics) {
  SQLite::Statement insert(db_, sql::insert_metric());
  for (const Metric& metric : metrics) {
    insert.reset();
    insert.bind(1, run_);
    insert.bind(2, metric.stage);
    insert.bind(3, metric.name);
    insert.bind(4, metric.unit);
    bindNumber(insert, 5, metric.value);
    insert.exec();
  }
}

void RunWriter::parameters(const std::string& stage,
                           const std::vector<ParameterEstimate>& parameters) {
  SQLite::Statement insert(db_, sql::insert_parameter());
  int position = 0;
  for (const ParameterEstimate& p : parameters) {
    insert.reset();
    insert.bind(1, run_);
    insert.bind(2, stage);
    insert.bind(3, position++);
    insert.bind(4, p.name);
    insert.bind(5, p.unit);
    bindNumber(insert, 6, p.value);
    bindNumber(insert, 7, p.std);
    bindNumber(insert, 8, p.resample_std.value_or(std::numeric_limits<double>::quiet_NaN()));
    insert.exec();
  }
}

void RunWriter::document(const std::string& name, const std::string& json) {
  SQLite::Statement insert(db_, sql::insert_document());
  insert.bind(1, run_);
  insert.bind(2, name);
  insert.bind(3, json);
  insert.exec();
}

void RunWriter::array(const std::string& name, const std::string& element,
                      const std::string& bytes) {
  SQLite::Statement insert(db_, sql::insert_array());
  insert.bind(1, run_);
  insert.bind(2, name);
  insert.bind(3, element);
  insert.bindNoCopy(4, static_cast<const void*>(bytes.data()), static_cast<int>(bytes.size()));
  insert.exec();
}

RunHead RunReader::head() const {
  SQLite::Statement query(db_, sql::select_run());
  query.bind(1, run_);
  if (!query.executeStep()) throw std::runtime_error("run " + std::to_string(run_) + " is missing");
  RunHead head;
  Provenance& p = head.provenance;
  int column = 0;
  head.kind = kindFrom(query.getColumn(column++).getString());
  for (std::string* text : {&head.name, &p.version, &p.command, &p.input, &p.input_hash, &p.date}) {
    *text = query.getColumn(column++).getString();
  }
  head.verdict = findings(levelFrom(query.getColumn(column).getString()));
  SQLite::Statement options(db_, sql::select_options());
  options.bind(1, run_);
  while (options.executeStep()) {
    p.options.emplace_back(options.getColumn(0).getString(), options.getColumn(1).getString());
  }
  return head;
}

Verdict RunReader::findings(VerdictLevel level) const {
  Verdict verdict;
  verdict.level = level;
  SQLite::Statement query(db_, sql::select_findings());
  query.bind(1, run_);
  while (query.executeStep()) {
    Finding& finding = verdict.findings.emplace_back();
    finding.rule = query.getColumn(0).getString();
    finding.level = levelFrom(query.getColumn(1).getString());
    finding.evidence = query.getColumn(2).getString();
    finding.advice = query.getColumn(3).getString();
    finding.value = number(query.getColumn(4));
    finding.threshold = number(query.getColumn(5));
    finding.unit = query.getColumn(6).getString();
  }
  return verdict;
}

std::optional<std::string> RunReader::document(const std::string& name) const {
  SQLite::Statement query(db_, sql::select_document());
  query.bind(1, run_);
  query.bind(2, name);
  if (!query.executeStep()) return std::nullopt;
  return query.getColumn(0).getString();
}

std::string RunReader::required(const std::string& name) const {
  auto json = document(name);
  if (!json) throw std::runtime_error("document '" + name + "' is missing");
  return std::move(*json);
}

std::string RunReader::array(const std::string& name, const std::string& element) const {
  SQLite::Statement query(db_, sql::select_array());
  query.bind(1, run_);
  query.bind(2, name);
  if (!query.executeStep()) throw std::runtime_error("array '" + name + "' is missing");
  if (query.getColumn(0).getString() != element) {
    throw std::runtime_error("array '" + name + "' has elements of an unknown form");
  }
  const SQLite::Column data = query.getColumn(1);
  return std::string(static_cast<const char*>(data.getBlob()),
                     static_cast<std::size_t>(data.getBytes()));
}

std::vector<RunSummary> listRuns(SQLite::Database& db) {
  SQLite::Statement query(db, sql::select_runs());
  std::vector<RunSummary> runs;
  while (query.executeStep()) {
    RunSummary& run = runs.emplace_back();
    run.id = query.getColumn(0).getInt64();
    run.kind = kindFrom(query.getColumn(1).getString());
    run.name = query.getColumn(2).getString();
    run.date = query.getColumn(3).getString();
    run.verdict = levelFrom(query.getColumn(4).getString());
  }
  return runs;
}

RunSummary chooseRun(SQLite::Database& db, std::optional<std::int64_t> wanted,
                     std::optional<RunKind> kind, const std::string& path) {
  const std::vector<RunSummary> runs = listRuns(db);
  if (runs.empty()) throw InputError(path, 0, "holds no run; run a command that writes one first");
  std::optional<RunSummary> chosen;
  for (const RunSummary& run : runs) {
    if (wanted ? run.id == *wanted : !kind || run.kind == *kind) chosen = run;
  }
  if (!chosen && wanted) {
    throw InputError(path, 0,
                     "holds no run " + std::to_string(*wanted) + "; its runs are " +
                         std::to_string(runs.front().id) + " to " + std::to_string(runs.back().id));
  }
  if (!chosen) throw InputError(path, 0, "holds no run of kind '" + toString(*kind) + "'");
  if (kind && chosen->kind != *kind) {
    throw InputError(path, 0,
                     "run " + std::to_string(chosen->id) + " is of kind '" +
                         toString(chosen->kind) + "', expected '" + toString(*kind) + "'");
  }
  return *chosen;
}

}  // namespace plumbline::store_internal
