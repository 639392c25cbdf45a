// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "report/records/study_record.h"

namespace plumbline {

/// Options of a command without "--", and their words ("" of a flag).
using StudyCommandOptions = std::vector<std::pair<std::string, std::string>>;

/// A participant's session as STUDY.yaml has it. Paths are absolute.
struct SessionEntry {
  StudySession row;                                         ///< what the definition says of it
  std::filesystem::path path;                               ///< of the recording
  std::vector<std::pair<std::string, std::string>> others;  ///< tool, calibration file
};

/// A recording under a name.
struct RecordingEntry {
  std::string name;
  std::filesystem::path path;
  std::filesystem::path truth;  ///< of a sequence for odometry; empty of a held-out recording
};

/// Whose board shape the calibrations of a study use.
enum class StudyTargetShape {
  kEach,  ///< each session's own calibration estimates it, where the recording determines it
  kOne,   ///< one for all, estimated from the first held-out recording
  kFlat,
  kFile,
};
constexpr std::array<const char*, 4> enumWords(StudyTargetShape /*of*/) {
  return {"each", "one", "flat", "FILE"};
}

/// From where on a change against earlier nights is a regression.
struct RegressionThresholds {
  double sigma = 4;      ///< of a session's figure: deviations from its rolling median
  double floor = 0.005;  ///< a deviation is at least this share of the median
  double cusum = 5;      ///< of a study's figure: cumulated deviations
  double slack = 0.5;    ///< deviations a night that are not cumulated
  int window = 14;       ///< nights that the rolling median is over

  /// Throws InputError for values out of range.
  void check() const;
};

/// Where the trajectories of a study come from: of pattern, command and odometry one is set at
/// most.
struct StudyTrajectories {
  std::string pattern;   ///< of files with {calibration}, {sequence}, {run}
  std::string command;   ///< with {calibration}, {sequence}, {out}
  std::string odometry;  ///< "builtin", "orbslam3", "openvins", or any other word where there is
  std::filesystem::path runner;      ///< a description of another system
  std::filesystem::path executable;  ///< of one that is not built in; empty: found by PATH
  int runs = 0;                      ///< of it; 0: what it needs at least
  /// Further options of `plumbline evaluate trajectory`, as in StudyDefinition::calibrate.
  StudyCommandOptions metrics;
};

/// STUDY.yaml, checked: every file that it names is there. Paths in it are relative to its folder.
struct StudyDefinition {
  std::filesystem::path file;
  std::string name;
  std::string rig;                              ///< its name; empty: not stated
  std::optional<std::filesystem::path> target;  ///< one board for all; unset: each session's own
  StudyTargetShape target_shape = StudyTargetShape::kEach;
  std::filesystem::path target_shape_file;  ///< of kFile
  StudyCommandOptions calibrate;            ///< further ones of `plumbline calibrate`
  double limit_s = 600;
  std::vector<std::string> methods;  ///< the first is the baseline
  std::vector<SessionEntry> sessions;
  std::vector<RecordingEntry> held_out;
  std::vector<RecordingEntry> sequences;
  StudyTrajectories trajectories;
  std::vector<double> offsets_ms;  ///< perturbations
  std::vector<std::string> endpoints;
  RegressionThresholds thresholds;
  double step_limit_s = 3600;  ///< wall time of a step
  int step_limit_mb = 8192;    ///< address space of a step
  bool cross = false;          ///< every calibration also on every other session
  bool replay = false;         ///< the guide replayed on every session
  bool keep_records = false;   ///< records.sqlite of every step, most of it single residuals
};

/// Throws InputError where a command has no such option, it takes no such words, or they cannot be
/// given together. The command line has these options, and gives this.
using StudyOptionCheck = std::function<void(const StudyCommandOptions& options)>;
struct StudyOptionChecks {
  StudyOptionCheck calibrate;   ///< of `plumbline calibrate`
  StudyOptionCheck trajectory;  ///< of `plumbline evaluate trajectory`, how errors are measured
};

/// Reads and checks a study as a whole. Throws InputError, or InputErrors of all that is wrong,
/// with file and line for unknown keys and words, values out of range or in another unit, files
/// that are not there, names that are given twice or cannot name a folder, participants without a
/// session of every method.
StudyDefinition readStudy(const std::string& path, const StudyOptionChecks& checks);

}  // namespace plumbline
