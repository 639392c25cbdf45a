// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <CLI/App.hpp>

#include "calibrator/base/error.h"
#include "evaluate/cli/command_tree.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/metrics/failure_text.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// Exit codes of the command line (docs/conventions.md): done; could not succeed; bad input or
/// usage; a study found a regression; the verdict is as bad as --fail-on says.
enum ExitCode { kDone = 0, kFailed = 1, kBadInput = 2, kRegression = 3, kVerdict = 4 };

/// One subcommand: `configure` declares its options on the given app and returns what runs when the
/// command was chosen. The handler returns an ExitCode and throws InputError for bad input.
struct Command {
  std::string name;
  std::string summary;
  std::string example;
  std::function<std::function<int()>(CLI::App&)> configure;
};

/// Puts commands below an app. What it returns runs the one that was chosen, after the parse.
inline std::function<int()> addCommands(CLI::App& app, const std::vector<Command>& commands) {
  std::map<std::string, std::function<int()>> handlers;
  for (const Command& command : commands) {
    CLI::App* sub = app.add_subcommand(command.name, command.summary);
    sub->footer("Example:\n  " + command.example);
    handlers[command.name] = command.configure(*sub);
  }
  return [handlers, &app] { return handlers.at(app.get_subcommands().front()->get_name())(); };
}

/// The `configure` of a command whose options are a struct: `declare` puts them on the app, `run`
/// does the work, with the options and, if it takes it, the app, and returns the ExitCode.
template <class Options, class Run>
auto withOptions(void (*declare)(CLI::App&, Options&), Run run) {
  return [declare, run](CLI::App& app) {
    auto options = std::make_shared<Options>();
    declare(app, *options);
    if constexpr (std::is_invocable_v<Run, Options&, CLI::App&>) {
      return std::function<int()>([options, run, &app] { return run(*options, app); });
    } else {
      return std::function<int()>([options, run] { return run(*options); });
    }
  };
}

/// The program: parses the command line, runs the command that was chosen, returns the exit code.
int runProgram(int argc, char** argv);

Command simulateCommand();
Command importCommand();
Command detectCommand();
Command calibrateCommand();
Command perturbCommand();
Command replayCommand();
Command reportCommand();
Command exportCommand();
Command compareCommand();
Command studyCommand();
Command completionCommand();
Command manCommand();
Command targetCommand();  ///< with subcommands
Command odometryCommand();
Command evaluateCommand();  ///< with subcommands

/// What `plumbline calibrate` itself says against its words, the last one first, as CLI11 takes a
/// vector; no file is opened. Throws InputError.
void checkCalibrateLine(std::vector<std::string> reversed);

// Of `simulate`.
Command simulateStudyCommand();
Command simulateSequenceCommand();
Command simulateOperatorCommand();

// Of `evaluate`.
Command evaluateCalibrationCommand();

/// Prints a failure of a command with its cure in one line and returns the exit code: data that
/// contradict what a file states are bad input.
inline int tellFailure(const Failure& failure, const CLI::App& command) {
  complain(withOwners(problemOf(failure), command));
  return failure.reason() == FailureReason::kImplausible ? kBadInput : kFailed;
}

/// withOwners() of all that scores and a verdict say.
inline void nameOwners(std::vector<CalibrationScore>& scores, const CLI::App& command) {
  for (CalibrationScore& score : scores) score.problem = withOwners(score.problem, command);
}
inline void nameOwners(Verdict& verdict, const CLI::App& command) {
  verdict.headline = withOwners(verdict.headline, command);
  for (Finding& finding : verdict.findings) {
    finding.evidence = withOwners(finding.evidence, command);
    finding.advice = withOwners(finding.advice, command);
  }
}

}  // namespace plumbline
