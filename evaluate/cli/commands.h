// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include <CLI/App.hpp>

namespace plumbline {

/// Exit codes of the command line (docs/conventions.md): done; could not succeed; bad input or
/// usage.
enum ExitCode { kDone = 0, kFailed = 1, kBadInput = 2 };

/// In place of an output file: standard output.
inline constexpr const char* kStandardOutput = "-";

/// One subcommand: `configure` declares its options on the given app and returns what runs when the
/// command was chosen. The handler returns an ExitCode and throws InputError for bad input.
struct Command {
  std::string name;
  std::string summary;
  std::string example;
  std::function<std::function<int()>(CLI::App&)> configure;
};

Command simulateCommand();
Command detectCommand();
Command calibrateCommand();
Command perturbCommand();
Command replayCommand();
Command reportCommand();
Command exportCommand();
Command compareCommand();
Command evaluateCommand();  ///< with subcommands; the table is in command_evaluate.cpp

/// The subcommands of `evaluate`.
Command evaluateTrajectoryCommand();
Command evaluateTrajectoriesCommand();
Command evaluateCalibrationCommand();

}  // namespace plumbline
