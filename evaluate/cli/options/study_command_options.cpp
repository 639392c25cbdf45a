// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/study_command_options.h"

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/command_tree.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/trajectory_metric_options.h"

namespace plumbline {
namespace {

// What a study decides itself, or what no result depends on.
void refuseReserved(const std::string& option) {
  for (const char* name : {"out", "force", "threads", "cache", "no-cache", "target", "target-shape",
                           "no-report", "json", "fail-on", "session"}) {
    if (option == name)
      throw InputError(fmt::format(
          "--{} is set by the study itself; remove it from the study's options", option));
  }
}

/// A line of a command's options after `start`, as CLI11 takes a vector.
std::vector<std::string> lineOf(std::vector<std::string> start,
                                const StudyCommandOptions& options) {
  for (const auto& [option, words] : options) {
    start.push_back("--" + option);
    if (!words.empty()) start.push_back(words);
  }
  std::reverse(start.begin(), start.end());
  return start;
}

}  // namespace

void checkCalibrateOptions(const StudyCommandOptions& options) {
  // Given cameras have their models: the plan gives those of the study to steps without them.
  StudyCommandOptions models, others;
  for (const auto& option : options) {
    refuseReserved(option.first);
    (option.first == "models" ? models : others).push_back(option);
  }
  for (const StudyCommandOptions& together : {models, others}) {
    checkCalibrateLine(lineOf({"session", "--out", "result"}, together));
  }
}

void checkTrajectoryOptions(const StudyCommandOptions& options) {
  CLI::App app;
  TrajectoryMetricWords metrics;
  declareTrajectoryMetrics(app, metrics);
  declareCoverage(app, metrics);
  parseReversed(app, "evaluate trajectory", lineOf({}, options));
  // Numbers were checked as they were parsed; words are where they are read.
  (void)judgedAs(metrics);
}

}  // namespace plumbline
