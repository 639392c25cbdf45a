// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "evaluate/study/step.h"

namespace plumbline {

/// In the night's folder: what its processes print.
inline constexpr const char* kEngineLog = "engine.log";

/// Where a night stands.
struct NightProgress {
  std::size_t done = 0, all = 0, failed = 0;  ///< of the steps that had to be done
  double seconds_left = -1;                   ///< estimated; negative: not known
  std::string step;                           ///< that ended last
  std::string message;                        ///< of it, if it failed
};
using NightSink = std::function<void(const NightProgress&)>;

/// The results that settle steps of a plan, by name.
using StepResults = std::map<std::string, StepResult>;

/// What is in the night's folder for these steps: only results that settle them,
/// with the commands as they are now (commandText()).
StepResults settledResults(const std::filesystem::path& night, const std::vector<Step>& steps);

/// Seconds that each step may take, by name: what it took before, under whatever key; else the
/// median of its kind; else a guess.
std::map<std::string, double> estimateSeconds(const std::filesystem::path& night,
                                              const std::vector<Step>& steps);

struct LocalEngineOptions {
  int jobs = 0;      ///< processes at once; 0: all cores
  int attempts = 3;  ///< at a step that is lost, though within its limits
};

/// Does the steps that are not settled, `jobs` at once, those first that with all that waits for
/// them take longest; each on one thread, unless there are fewer steps than jobs. A step whose need
/// failed is left out. Returns what settles or ended each step; steps left out have no result.
StepResults runLocally(const std::filesystem::path& night, const std::vector<Step>& steps,
                       const LocalEngineOptions& options, const NightSink& sink);

}  // namespace plumbline
