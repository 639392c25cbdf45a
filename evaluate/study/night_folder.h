// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "evaluate/study/definition/definition.h"

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

}  // namespace plumbline
