// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "evaluate/study/definition.h"
#include "evaluate/study/step.h"
#include "report/records/study_record.h"
#include "report/store/study_store.h"

namespace plumbline {

// What lies in a study's folder, beside the folders of its sessions and recordings.
inline constexpr const char* kStudyMarkFile = "plumbline-study.json";  ///< whose folder it is
inline constexpr const char* kHistoryFile = "study.sqlite";
inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr const char* kIndexFile = "index.html";
inline constexpr const char* kHashesFile = "hashes.txt";
inline constexpr const char* kEngineLog = "engine.log";  ///< what its processes print

/// As long as a night that was just killed may have been starting a program, which holds the lock
/// until then [s].
inline constexpr double kNightLockWaitS = 0.4;

/// A study's folder while a night changes it: no other process does.
class NightLock {
 public:
  /// Throws InputError where another process still holds it after `wait_s`, saying which, and where
  /// it cannot be written.
  explicit NightLock(const std::filesystem::path& folder, double wait_s = kNightLockWaitS);
  ~NightLock();
  NightLock(const NightLock&) = delete;
  NightLock& operator=(const NightLock&) = delete;

 private:
  int file_ = -1;
};

/// Makes the study's folder, or takes the one that is there: empty, or this study's. Throws
/// InputError for a folder of something else or of another study, for one that lies in a recording
/// or holds one, and where it cannot be written.
void takeNightFolder(const std::filesystem::path& folder, const StudyDefinition& study);

/// Removes what processes that were killed left: temporary files in the study's folder, and beside
/// the folders of steps, planned or not, the results in the making (removeDeadWorkplaces()).
void removeLeftovers(const std::filesystem::path& folder);

/// Throws InputError unless a study's results lie in the folder.
void requireNightFolder(const std::filesystem::path& folder);

/// What is wrong with the last night's figures against the nights before.
///
/// Same inputs and same version: another value is an alarm ("deterministic"), for every figure that
/// is not a duration; of "failed" and "failed/STEP" a larger one only.
///
/// Otherwise a session's figure x of night n is compared with its own past under the same inputs
/// ("median"): bad where
///   x_n - median > sigma max(1.4826 MAD, floor |median|, least)
/// over the last `window` nights that were not bad themselves; "failed" and "failed/STEP" where
/// they were 0 on any of these. The alarm names the first night of the unbroken run of bad ones.
///
/// And a study's ("cusum"): d_n is the median over sessions of (x_n - x_r) / max(|x_r|, least /
/// floor), r the session's first night under the same inputs, so that only sessions that both
/// nights have are compared, x_n the median above where the night is bad by that rule; S_n = max(0,
/// S_{n-1} + d_n / s_n - slack), s_n = max(1.4826 MAD, floor) over d of the first `window` nights
/// up to n, an alarm above `cusum`, its first night the one after S was last 0.
///
/// A figure that was accepted on a night starts anew there.
std::vector<StudyAlarm> judgeNight(int night, const std::vector<FigureSpan>& figures,
                                   const std::vector<StudyAcceptance>& accepted,
                                   const RegressionThresholds& thresholds);

/// Sessions without a calibration on the last night that had one on an earlier night, but from
/// other data or options only: judgeNight() has nothing to compare them with.
std::vector<std::string> calibratedFromOtherInputs(int night,
                                                   const std::vector<FigureSpan>& figures);

/// What a night's steps say together.
struct MergedNight {
  StudyRecord record;  ///< without statistics, alarms and nights
  std::vector<StudyFigure> figures;
  int steps_failed = 0;    ///< with a result that is a failure
  int steps_left_out = 0;  ///< without a result, as is something that they need
  int steps_missing = 0;   ///< without a result, though what they need is done
};

/// A finding by a count that is 0 where all is well: good, as long as nobody makes it worse.
inline Finding countFinding(const std::string& rule, std::size_t count,
                            const std::string& evidence) {
  return {rule, VerdictLevel::kGood, evidence, "", static_cast<double>(count), 0, "1"};
}

/// Puts the steps' rows beside what the definition says of their sessions, in its order. A session
/// without a calibration is failed, with its step and message; other failures stand in the rows
/// that they leave without a figure. Reads the rows from the night's folder.
MergedNight mergeNight(const StudyDefinition& study, const std::filesystem::path& night,
                       const std::vector<Step>& steps, const StepResults& results);

/// What `plumbline study` is asked to do.
struct NightRequest {
  std::string study;          ///< STUDY.yaml
  std::filesystem::path out;  ///< the study's folder, the same every night
  StudyOptionChecks checks;   ///< of the definition
  bool redo_failed = false;   ///< steps that failed are done again, though nothing changed
  int recheck = 0;            ///< so many steps that are done are done again: is the result equal?
  Provenance provenance;
  double lock_wait_s = kNightLockWaitS;
  /// Asked under the lock, before anything in the folder changes; throws where another night is
  /// under way, or was begun since, that does not hold the lock. Empty: not asked.
  std::function<void(const std::filesystem::path& folder)> refuse;
  int number = 0;  ///< of a night that another process began, and that is the last; 0: the next one
};

/// A night that may begin: its folder is taken, its plan is written.
struct PreparedNight {
  StudyDefinition study;
  std::filesystem::path folder;
  std::vector<Step> steps;
  std::unique_ptr<NightLock> lock;
  Provenance provenance;
  int number = 0;  ///< from 1
};

/// Reads and checks the study, takes the folder and its lock, hashes the inputs and writes the
/// plan. Throws InputError as these do, and where a later night than the one asked for counts;
/// nothing was changed then but the folder's mark.
PreparedNight prepareNight(const NightRequest& request);

/// What a night came to.
struct NightOutcome {
  int night = 0;
  int sessions = 0, sessions_failed = 0;
  std::size_t steps = 0;
  int steps_failed = 0, steps_left_out = 0, steps_missing = 0;
  std::vector<StudyAlarm> alarms;              ///< not accepted
  std::vector<std::string> calibrated_before;  ///< calibratedFromOtherInputs()
  VerdictLevel level = VerdictLevel::kGood;
  std::string document;  ///< summary.json
};

/// Merges the results, compares them with the nights before, and writes records.sqlite,
/// summary.json and index.html, and last study.sqlite, with which the night counts. A night that is
/// stopped before has not been; one that counts already, as who merged it was killed before anybody
/// knew, is not added again.
NightOutcome finishNight(const PreparedNight& night, const StepResults& results, double seconds);

/// The night's result for a terminal.
std::string nightSummary(const NightOutcome& outcome, const std::filesystem::path& folder);

/// Marks changes as found right: those of a session, of a figure ("" for all). They are judged from
/// the last night on. Returns the alarms that this ends; throws InputError where there are none,
/// and as NightLock does.
std::vector<StudyAlarm> acceptChanges(const std::filesystem::path& folder,
                                      const std::string& session, const std::string& figure,
                                      const std::string& note);

}  // namespace plumbline
