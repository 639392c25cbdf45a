// SPDX-License-Identifier: BSD-3-Clause
// `plumbline evaluate WHAT`: a table of what can be evaluated, each a command of its own.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "evaluate/cli/commands.h"

namespace plumbline {
namespace {

std::vector<Command> evaluations() {
  return {evaluateTrajectoryCommand(), evaluateTrajectoriesCommand(), evaluateCalibrationCommand()};
}

}  // namespace

Command evaluateCommand() {
  return {"evaluate", "Judge results against what is known better",
          "plumbline evaluate trajectory estimate.txt groundtruth.csv", [](CLI::App& app) {
            app.require_subcommand(1);
            std::map<std::string, std::function<int()>> handlers;
            for (const Command& command : evaluations()) {
              CLI::App* sub = app.add_subcommand(command.name, command.summary);
              sub->footer("Example:\n  " + command.example);
              handlers[command.name] = command.configure(*sub);
            }
            return std::function<int()>([handlers, &app] {
              return handlers.at(app.get_subcommands().front()->get_name())();
            });
          }};
}

}  // namespace plumbline
