// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/night.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/results/text.h"
#include "evaluate/statistics/study_statistics.h"
#include "evaluate/study/history.h"
#include "evaluate/study/merge.h"
#include "evaluate/study/plan.h"
#include "evaluate/study/run_step.h"
#include "report/html/pages.h"
#include "report/records/documents.h"
#include "report/store/store.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

int nightAfter(const StudyStore& store) {
  const auto nights = store.nights();
  return nights.empty() ? 1 : nights.back().night + 1;
}

/// Of a job that Slurm runs once more after its night, say: it would write that night's figures
/// over the later one's.
void refuseAfterLaterNight(const StudyStore& store, int number, const fs::path& folder) {
  const int last = nightAfter(store) - 1;
  if (last <= number) return;
  throw badInput(folder.string(),
                 {InputFault::kOther,
                  fmt::format("night {} is over, and night {} was merged after it; nothing is "
                              "changed",
                              number, last)});
}

// Another part of the done steps every night, so that all have their turn.
void chooseRechecks(const fs::path& folder, const std::vector<Step>& steps, int count, int night) {
  std::vector<const Step*> done;
  for (const Step& step : steps) {
    const auto result = readStepResult(folder / step.name);
    if (result && result->settles(step) && result->status == StepStatus::kDone) {
      done.push_back(&step);
    }
  }
  const auto n = std::min(static_cast<std::size_t>(count), done.size());
  for (std::size_t i = 0; i < n; ++i) {
    forgetResult(folder / done[(static_cast<std::size_t>(night) * n + i) % done.size()]->name);
  }
}

/// Failed steps only: lost ones are done again anyhow.
void forgetFailures(const fs::path& folder, const std::vector<Step>& steps) {
  for (const Step& step : steps) {
    const auto result = readStepResult(folder / step.name);
    if (result && result->status == StepStatus::kFailed) forgetResult(folder / step.name);
  }
}

std::optional<double> medianHeldOut(const StudyRecord& record) {
  std::vector<double> values;
  for (const StudySession& s : record.sessions) {
    if (s.held_out_rmse_px) values.push_back(*s.held_out_rmse_px);
  }
  return values.empty() ? std::nullopt : std::optional(median(values));
}

StudyNight nightOf(const StudyRecord& record, int number, double seconds) {
  StudyNight night;
  night.night = number;
  night.date = record.provenance.date;
  night.version = programVersion();
  night.sessions = static_cast<int>(record.sessions.size());
  night.failed = static_cast<int>(failedSessions(record));
  night.seconds = seconds;
  night.held_out_rmse_px = medianHeldOut(record);
  return night;
}

std::vector<StudyStepRow> stepRows(const std::vector<Step>& steps, const StepResults& results) {
  std::vector<StudyStepRow> rows;
  for (const Step& step : steps) {
    const auto result = results.find(step.name);
    if (result == results.end()) continue;
    const StepResult& r = result->second;
    rows.push_back({r.name, r.key, toString(r.status), r.message, r.command, r.seconds, r.peak_mb});
  }
  return rows;
}

std::string alarmSentence(const StudyAlarm& a) {
  const std::string where = a.session.empty() ? "of the study" : "of " + a.session;
  if (a.kind == "deterministic") {
    return fmt::format("{} {} is {:.9g} and was {:.9g} from the same inputs and version", a.metric,
                       where, a.is, a.was);
  }
  if (isDrift(a)) {
    return fmt::format("{} {} has become worse{} than on its first night, gradually", a.metric,
                       where, hasShare(a) ? fmt::format(" by {:.3g} %", 100 * a.is) : "");
  }
  // Of failures was the least, which is no median.
  const bool failure = a.metric == "failed" || a.metric.starts_with("failed/");
  return fmt::format("{} {} is {:.6g}, {} before {:.6g}", a.metric, where, a.is,
                     failure ? "and was" : "its median", a.was);
}

Finding endpointFinding(const StudyRecord& record) {
  const auto unknown = unknownEndpoints(record);
  Finding f = countFinding("Endpoints", unknown.size(), "every declared endpoint has figures");
  if (unknown.empty()) return f;
  f.level = VerdictLevel::kCaution;
  f.evidence = fmt::format("no session has a figure of {}", fmt::join(unknown, ", "));
  // A misspelt name of a parameter, say: only the calibrations know those (isEndpoint()).
  f.advice = failedSessions(record) == record.sessions.size()
                 ? "No session has a calibration, which figures come from: see why first"
                 : "Correct endpoints in the study, or record what they require";
  return f;
}

Finding calibratedBeforeFinding(const std::vector<std::string>& sessions) {
  Finding f = countFinding(
      "Sessions calibrated before", sessions.size(),
      fmt::format("without a calibration, but with one on an earlier night from other data or "
                  "options: {}",
                  fmt::join(sessions, ", ")));
  f.level = VerdictLevel::kCaution;
  f.advice = "Look whether their recordings are whole, and which options changed";
  return f;
}

/// What earlier nights say where no figure is worse.
std::string noneWorse(const StudyRecord& record) {
  return record.nights.size() > 1 ? "no figure is worse than on the nights before"
                                  : "no night before has figures to compare with";
}

/// "7 of 8 sessions are calibrated, 2 of them with a bad verdict".
std::string calibratedWords(const StudyRecord& record) {
  const StudyNight& night = record.nights.back();
  const auto bad = std::ranges::count(record.sessions, VerdictLevel::kBad, &StudySession::verdict);
  return fmt::format("{} of {} sessions are calibrated{}", night.sessions - night.failed,
                     night.sessions,
                     bad == 0 ? "" : fmt::format(", {} of them with a bad verdict", bad));
}

/// What is known after the merge: regressions against earlier nights, sessions whose data or
/// options changed and give no calibration any more, and declared endpoints without figures.
void addFurtherFindings(StudyRecord& record, const std::vector<std::string>& calibrated_before) {
  Finding finding = countFinding("Regressions", record.alarms.size(), noneWorse(record));
  if (!record.alarms.empty()) {
    finding.level = VerdictLevel::kBad;
    finding.evidence =
        fmt::format("{} figures changed; first, since night {}: {}", record.alarms.size(),
                    record.alarms.front().night, alarmSentence(record.alarms.front()));
    finding.advice =
        "Look at the commands of the alarms; plumbline study accept marks a change as intended";
  }
  auto findings = std::move(record.verdict.findings);
  findings.push_back(std::move(finding));
  if (!calibrated_before.empty()) findings.push_back(calibratedBeforeFinding(calibrated_before));
  if (!record.endpoints.empty()) findings.push_back(endpointFinding(record));
  record.verdict = makeVerdict(std::move(findings));
  // The headline of a good study is what it found, of any other what is wrong.
  const auto& sentences = record.statistics.sentences;
  const std::string known = sentences.empty() ? "" : sentences.front() + "; ";
  record.verdict.headline =
      headlineOf(record.verdict, known + calibratedWords(record) + "; " + noneWorse(record));
}

// The store is this night's alone: its history is in study.sqlite. Made beside it and renamed,
// since Store adds to a file that is there, and a reader shall never find half of one.
void writeRecords(const fs::path& folder, const StudyRecord& record) {
  const fs::path made = folder / ".records.sqlite.new";
  std::error_code ignored;
  fs::remove(made, ignored);
  Store(made).save(record);
  fs::rename(made, folder / kRecordsFile);
}

}  // namespace

PreparedNight prepareNight(const NightRequest& request) {
  PreparedNight night;
  night.study = readStudy(request.study, request.checks);
  takeNightFolder(request.out, night.study);
  night.folder = fs::canonical(request.out);
  night.lock = std::make_unique<NightLock>(night.folder, request.lock_wait_s);
  if (request.refuse) request.refuse(night.folder);
  night.provenance = request.provenance;
  const StudyStore store(night.folder /
                         kHistoryFile);  // a newer one ends the night before its work
  if (request.number > 0) refuseAfterLaterNight(store, request.number, night.folder);
  night.number = request.number > 0 ? request.number : nightAfter(store);
  InputHashes hashes(night.folder / kHashesFile);
  night.steps = planStudy(night.study, hashes, {programVersion(), runningProgramHash()});
  hashes.save();
  writeFileAtomically((night.folder / kPlanFile).string(), planText(night.steps));
  // Every process of the night appends to it.
  writeFileAtomically((night.folder / kEngineLog).string(), "");
  // Only now that the lock keeps others away.
  removeLeftovers(night.folder);
  if (request.redo_failed) forgetFailures(night.folder, night.steps);
  if (request.recheck > 0) {
    chooseRechecks(night.folder, night.steps, request.recheck, night.number);
  }
  return night;
}

NightOutcome finishNight(const PreparedNight& night, const StepResults& results, double seconds) {
  MergedNight merged = mergeNight(night.study, night.folder, night.steps, results);
  StudyRecord& record = merged.record;
  record.provenance = night.provenance;
  record.provenance.input = night.study.file.filename().string();
  // Of the study as a whole: any input that changes changes it, and the program does not.
  std::string keys;
  for (const Step& step : night.steps) keys += step.inputs_key;
  record.provenance.input_hash = "xxh64:" + contentHash(keys);
  StudyStore store(night.folder / kHistoryFile);
  const int number = night.number;
  const bool counts = nightAfter(store) > number;
  // In memory until it is saved: the night is judged as the last one of its own history.
  if (!counts) {
    store.addNight(nightOf(record, number, seconds), merged.figures);
    store.setSteps(number, stepRows(night.steps, results));
  }
  record.alarms = judgeNight(number, store.figures(), store.accepted(), night.study.thresholds);
  if (!counts) store.addAlarms(number, record.alarms);
  record.nights = store.nights();
  addStatistics(record);
  NightOutcome outcome;
  outcome.calibrated_before = calibratedFromOtherInputs(number, store.figures());
  addFurtherFindings(record, outcome.calibrated_before);
  writeRecords(night.folder, record);
  outcome.level = record.verdict.level;
  outcome.document = documentOf(record);
  writeFileAtomically((night.folder / kSummaryFile).string(), outcome.document);
  writeFileAtomically((night.folder / kIndexFile).string(), renderStudyPage(record));
  // Last of all, as this makes the night count: one that is killed before has not been, and the
  // next night has its number.
  if (!counts) store.save();
  outcome.night = number;
  outcome.sessions = record.nights.back().sessions;
  outcome.sessions_failed = record.nights.back().failed;
  outcome.steps = night.steps.size();
  outcome.steps_failed = merged.steps_failed;
  outcome.steps_left_out = merged.steps_left_out;
  outcome.steps_missing = merged.steps_missing;
  outcome.alarms = record.alarms;
  return outcome;
}

std::string nightSummary(const NightOutcome& o, const fs::path& folder) {
  constexpr std::size_t kShown = 10;
  Text text;
  add(text, "Night {}: {} of {} sessions have a calibration", o.night,
      o.sessions - o.sessions_failed, o.sessions);
  if (o.steps_failed + o.steps_missing > 0) {
    add(text, "; of {} steps {} failed, {} that need them were left out, {} were not done", o.steps,
        o.steps_failed, o.steps_left_out, o.steps_missing);
  }
  add(text, "\n");
  if (!o.calibrated_before.empty()) {
    add(text, "  had one on an earlier night, from other data or options: {}\n",
        fmt::join(o.calibrated_before, ", "));
  }
  if (!o.alarms.empty()) {
    add(text, "REGRESSION: {} figures changed against earlier nights\n", o.alarms.size());
  }
  for (std::size_t i = 0; i < std::min(kShown, o.alarms.size()); ++i) {
    const StudyAlarm& a = o.alarms[i];
    add(text, "  since night {}: {}\n    {}\n", a.night, alarmSentence(a), a.command);
  }
  if (o.alarms.size() > kShown) add(text, "  and {} more\n", o.alarms.size() - kShown);
  add(text, "Report: {}\n", (folder / kIndexFile).string());
  return fmt::to_string(text);
}

std::vector<StudyAlarm> acceptChanges(const fs::path& folder, const std::string& session,
                                      const std::string& figure, const std::string& note) {
  requireNightFolder(folder);
  const NightLock lock(folder);
  StudyStore store(folder / kHistoryFile);
  const int night = nightAfter(store) - 1;
  std::vector<StudyAlarm> ended;
  for (const StudyAlarm& a : store.alarms(night)) {
    // An alarm of the whole study stays where one session starts anew.
    const bool of_session = session.empty() || a.session == session;
    const bool of_figure =
        figure.empty() || a.metric == figure || a.metric.substr(0, a.metric.find('/')) == figure;
    if (of_session && of_figure) ended.push_back(a);
  }
  if (ended.empty()) {
    throw InputError(folder.string(), 0,
                     fmt::format("night {} has no alarm of that session and figure; summary.json "
                                 "lists its alarms",
                                 night));
  }
  store.accept({night, session, figure, note, makeProvenance("", {}).date});
  store.save();
  return ended;
}

}  // namespace plumbline
