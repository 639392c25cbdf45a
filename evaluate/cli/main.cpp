// SPDX-License-Identifier: BSD-3-Clause
// The one binary: a table of subcommands, and the only place where errors become exit codes.
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <malloc.h>

#include "datasets/files/bad_input.h"
#include "evaluate/cli/commands.h"
#include "generated/version.h"

namespace plumbline {
namespace {

std::vector<Command> commands() {
  return {simulateCommand(), detectCommand(),  calibrateCommand(),
          evaluateCommand(), compareCommand(), exportCommand(),
          perturbCommand(),  replayCommand(),  reportCommand()};
}

// " evaluate trajectory": the commands that were chosen, one within the other.
std::string chosenWords(const CLI::App& app) {
  std::string words;
  for (auto chosen = app.get_subcommands(); !chosen.empty();
       chosen = chosen.front()->get_subcommands()) {
    words += " " + chosen.front()->get_name();
  }
  return words;
}

// The option that puts right what the libraries, which know no options, found wrong; "": none does.
std::string optionFor(InputFault code) {
  switch (code) {
    case InputFault::kNoTarget:
      return "; --target FILE names it";
    case InputFault::kNoResolution:
      return "; --resolution WxH states it";
    case InputFault::kNoCorners:
      return "; run plumbline detect on it first";
    case InputFault::kNoImuNoise:
      return "; --imu imu.yaml gives its noise densities";
    case InputFault::kNoImuSamples:
      return "; --no-imu leaves the IMU out";
    case InputFault::kNoCache:
      return "; --cache DIR names another, --no-cache none";
    case InputFault::kNothingSelected:
      return "; correct --from and --to";
    case InputFault::kUnsupportedModel:
      return "; --models chooses it";
    case InputFault::kUnknownCamera:
      return "; correct --only";
    case InputFault::kTooManyCameras:
      return "; --only chooses cameras, e.g. --only cam0,cam1";
    case InputFault::kBadCameraRate:
      return "; correct --camera-rate";
    default:
      return "";
  }
}

int runChosen(const CLI::App& app, const std::map<std::string, std::function<int()>>& handlers) {
  try {
    return handlers.at(app.get_subcommands().front()->get_name())();
  } catch (const BadInput& error) {
    fmt::print(stderr, "plumbline: {}{}\n", error.what(), optionFor(error.code()));
    return kBadInput;
  } catch (const InputError& error) {
    fmt::print(stderr, "plumbline: {}\n", error.what());
    return kBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    fmt::print(stderr, "plumbline: {}: {}; check the path and its permissions\n",
               error.path1().string(), error.code().message());
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "plumbline: unexpected failure: {}\n", error.what());
    return kFailed;
  }
}

// Big arrays go back to the system as soon as they are freed. Left alone, glibc raises this limit
// with the first big array that is freed, keeps the later ones on its heap, and the peak grows by a
// quarter (127 against 102 MB for both stages of a stereo recording of 72 s).
void returnFreedArrays() { mallopt(M_MMAP_THRESHOLD, 256 * 1024); }

int run(int argc, char** argv) {
  returnFreedArrays();
  CLI::App app{"Calibrates and judges camera-IMU rigs from recordings of an AprilGrid.",
               "plumbline"};
  app.set_version_flag("--version", kVersion);
  app.require_subcommand(1);
  std::map<std::string, std::function<int()>> handlers;
  for (const Command& command : commands()) {
    CLI::App* sub = app.add_subcommand(command.name, command.summary);
    sub->footer("Example:\n  " + command.example);
    handlers[command.name] = command.configure(*sub);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    fmt::print(stderr, "plumbline: {}; see plumbline{} --help\n", error.what(), chosenWords(app));
    return kBadInput;
  }
  return runChosen(app, handlers);
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) { return plumbline::run(argc, argv); }
