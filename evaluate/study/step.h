// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/fields/fields.h"
#include "report/records/study_record.h"

namespace plumbline {

/// What a step does; each but kEstimate is a command of this program.
enum class StepKind {
  kDetect,  ///< corners of a recording that comes as images
  kBoard,   ///< the board's shape from the first held-out recording
  kCalibrate,
  kPerturb,
  kEvaluate,    ///< a calibration held fixed on a recording
  kCompare,     ///< another tool's result beside ours
  kEstimate,    ///< the study's own command makes a trajectory
  kTrajectory,  ///< a trajectory against its truth
  kOdometry,    ///< an odometry with a calibration, and its trajectories against their truth
  kReplay,
};
constexpr std::array<const char*, 10> enumWords(StepKind /*of*/) {
  return {"detect",  "board",    "calibrate",  "perturb",  "evaluate",
          "compare", "estimate", "trajectory", "odometry", "replay"};
}

/// What made a result, besides its inputs.
struct ProgramId {
  std::string version;  ///< programVersion()
  std::string hash;     ///< runningProgramHash()
};

/// A file or folder that a step reads, in the state that its key is of.
struct StepInput {
  std::string path, stamp;
};

template <class V>
void fields(V& v, StepInput& i) {
  v("path", i.path, "absolute");
  v("stamp", i.stamp, "see stampOf()");
}

/// A step that must be done before.
struct StepNeed {
  std::string name, key;
};

template <class V>
void fields(V& v, StepNeed& n) {
  v("name", n.name, "of the step");
  v("key", n.key, "of the result that is needed");
}

/// A piece of a night's work: one process, one result folder. Its key names what the result is of:
/// equal keys, equal results.
struct Step {
  std::string name;  ///< its folder below the night's, e.g. "sessions/p01_free/calibrate"
  StepKind kind = StepKind::kCalibrate;
  std::string session;  ///< whose result; empty of recordings that belong to none
  std::string part;     ///< recording, tool, "tool/recording" or "sequence/run"
  /// Of the command. "{out}" stands for the result's folder, "{threads}" for a number,
  /// "{result:STEP}" for that step's folder, "{shape:STEP}" for the board's shape that it found
  /// ("flat" if it found none).
  std::vector<std::string> words;
  std::vector<StepInput> inputs;
  std::vector<StepNeed> needs;
  std::string inputs_key;  ///< of inputs' contents and options
  std::string key;         ///< of these and the program
  std::string program;     ///< runningProgramHash() of who planned it
  double limit_s = 3600;
  int limit_mb = 8192;
  bool keep_records = false;  ///< otherwise records.sqlite is removed when its rows are read
};

template <class V>
void fields(V& v, Step& s) {
  v("name", s.name, "its folder");
  v("kind", s.kind, "what it does");
  v("session", s.session, "whose result");
  v("part", s.part, "recording, tool, sequence");
  v("words", s.words, "of the command");
  v("inputs", s.inputs, "what it reads");
  v("needs", s.needs, "steps before");
  v("inputs_key", s.inputs_key, "of contents and options");
  v("key", s.key, "of these and the version");
  v("program", s.program, "hash of the program's file");
  v("limit_s", s.limit_s, "wall time");
  v("limit_mb", s.limit_mb, "address space");
  v("keep_records", s.keep_records, "whether records.sqlite stays");
}

/// Which state of a file or folder this is, without reading it: XXH64 over path below the folder,
/// size, both times of change and inode of every file in it, links followed, hidden ones left out.
/// Any write changes it, unless the clock was set back. Throws InputError where `path` is not there
/// or a folder in it cannot be listed.
std::string stampOf(const std::filesystem::path& path);

/// XXH64 over the contents of files and folders, whatever their place: of a folder over the paths
/// below it and the contents of its files, hidden ones left out. What was hashed before and has the
/// same stampOf() is not read again.
class InputHashes {
 public:
  /// Reads what was hashed before, where `cache` is there and whole.
  explicit InputHashes(std::filesystem::path cache);

  struct Hashed {
    std::string content;  ///< 16 hexadecimal digits
    std::string stamp;
  };
  /// Throws InputError where `path` cannot be read.
  Hashed of(const std::filesystem::path& path);

  /// Writes the cache, whole or not at all; InputError where it cannot.
  void save() const;

 private:
  std::filesystem::path cache_;
  std::map<std::string, Hashed> known_;  // by path
  std::map<std::string, Hashed> seen_;   // asked for by this process
};

struct StudyDefinition;

/// The steps of a study's night, each after those that it needs, with their keys: of the contents
/// of what they read, of options, and of the program. Names of sessions and files are in no key but
/// where results show them. Throws InputError where an input cannot be read.
std::vector<Step> planStudy(const StudyDefinition& study, InputHashes& hashes,
                            const ProgramId& program);

/// Name of the plan in a study's folder.
inline constexpr const char* kPlanFile = "plan.jsonl";

/// The plan's text: a line (JSON) for each step.
std::string planText(const std::vector<Step>& steps);
/// The step of this name in a plan's file. Throws InputError where there is none.
Step readPlannedStep(const std::filesystem::path& plan, const std::string& name);

/// How a step ended.
enum class StepStatus {
  kDone,
  kFailed,   ///< the command refused or failed: it would again
  kLost,     ///< by a kill, a crash, a limit or a full disk: done again the next time
  kChanged,  ///< an input changed since the night was planned: done again the next time
};
constexpr std::array<const char*, 4> enumWords(StepStatus /*of*/) {
  return {"done", "failed", "lost", "changed"};
}

/// What a step left: step.json in its folder. The folder takes its name when all of it is there.
struct StepResult {
  std::string name, key, inputs_key, version;
  StepStatus status = StepStatus::kDone;
  std::string message;  ///< of what failed; empty if nothing did
  std::string command;  ///< to do it by hand
  std::string date;
  double seconds = 0, cpu_s = 0, peak_mb = 0;
  double limit_s = 0;  ///< it ran under
  int limit_mb = 0;

  /// Whether the step need not be done again: it would give the same.
  bool settles(const Step& step) const {
    const bool same_limits = limit_s == step.limit_s && limit_mb == step.limit_mb;
    return key == step.key &&
           (status == StepStatus::kDone || (status == StepStatus::kFailed && same_limits));
  }
};

template <class V>
void fields(V& v, StepResult& r) {
  v("name", r.name, "of the step");
  v("key", r.key, "of inputs, options and version");
  v("inputs_key", r.inputs_key, "of inputs and options");
  v("version", r.version, "of the program");
  v("status", r.status, "`done`, `failed`, `lost`, `changed`");
  v.ifSet("message", r.message, "of what failed");
  v("command", r.command, "to run it by hand");
  v("date", r.date, "UTC");
  v("seconds", r.seconds, "s", "wall time");
  v("cpu_s", r.cpu_s, "s", "of the processor");
  v("peak_mb", r.peak_mb, "resident memory");
  v("limit_s", r.limit_s, "s", "it ran under");
  v("limit_mb", r.limit_mb, "it ran under");
}

inline constexpr const char* kStepFile = "step.json";

/// step.json: the result, and under "part" the rows that it gives the study.
std::string stepText(const StepResult& result, const StudyRecord& part);
/// Empty where there is none, or none that this version reads.
std::optional<StepResult> readStepResult(const std::filesystem::path& folder);
/// Without its mark a result counts as not there.
void forgetResult(const std::filesystem::path& folder);
/// The rows of a step that is done. Throws InputError where they cannot be read.
StudyRecord readStepPart(const std::filesystem::path& folder);

/// The results that settle steps of a plan, by name.
using StepResults = std::map<std::string, StepResult>;

/// What is in the night's folder for these steps: only results that settle them,
/// with the commands as they are now (commandText()).
StepResults settledResults(const std::filesystem::path& night, const std::vector<Step>& steps);

/// The rows that a finished step gives the study, from the records that its command left in
/// `folder`: of kCalibrate one session, of kEvaluate one held-out score, of kPerturb a row an
/// offset, of kCompare another tool's differences, of kTrajectory one trajectory, of kOdometry one
/// a run; of kReplay the session's compliance; none of the others. Throws InputError where the
/// records cannot be read.
StudyRecord rowsOf(const Step& step, const std::filesystem::path& folder);

/// The row of a trajectory step without a figure; its part is "SEQUENCE/RUN" or "SEQUENCE".
StudyTrajectory emptyTrajectory(const Step& step, const std::string& failure = "");

/// Does a step of the plan in `night`, unless its result is there: runs its command as a process of
/// its own under the step's limits, takes the rows of the study from its records, and gives the
/// result its folder at once, also where the command failed. Nothing is left behind by a process
/// that is killed but a hidden folder, which the next night removes.
///
/// An input that is not as the plan has it, before or after, makes the result `kChanged`. Returns
/// what is there now. Throws InputError where the plan or a step that is needed is missing, the
/// plan is of another build, or the result cannot be written.
StepResult runStep(const std::filesystem::path& night, const std::string& name, int threads);

/// The step's command as a person may type it, with OUT for the folder, while the results that it
/// needs lie in `night`.
std::string commandText(const Step& step, const std::filesystem::path& night);

/// Records that a step's process was lost before it could say anything itself.
StepResult recordLost(const std::filesystem::path& night, const Step& step,
                      const std::string& message);

/// Of the contents of the program that runs.
std::string runningProgramHash();

}  // namespace plumbline
