// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "evaluate/study/definition/definition.h"
#include "evaluate/study/night_folder.h"
#include "evaluate/study/step_result.h"
#include "report/records/study_record.h"

namespace plumbline {

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
