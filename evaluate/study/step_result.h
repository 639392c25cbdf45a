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
#include "evaluate/study/step.h"
#include "report/records/study_record.h"

namespace plumbline {

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

void fields(auto& v, StepResult& r) {
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

}  // namespace plumbline
