// SPDX-License-Identifier: BSD-3-Clause
// The one binary: a table of subcommands, and the only place where errors become exit codes.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <malloc.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/workplace.h"
#include "evaluate/cli/command_tree.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/process/process.h"
#include "evaluate/results/provenance.h"

namespace plumbline {
namespace {

/// A signal is ending the process: see waitIfEnding().
std::atomic<bool> ending{false};

/// Waits for one of the signals. Ends by _exit(), as other threads go on and may hold any lock:
/// neither destructors nor exit handlers could run beside them.
[[noreturn]] void endOn(sigset_t awaited) {
  int signal = 0;
  while (sigwait(&awaited, &signal) != 0) {
  }
  ending = true;
  killChildren();  // else they would write on into what is being removed
  abandonWorkplaces();
  const char* clear = isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "";
  writeError(fmt::format("{}plumbline: stopped by signal {}; unfinished output was removed\n",
                         clear, signal));
  // As a shell reports a process that a signal ended.
  _exit(128 + signal);
}

bool isIgnored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// From here on SIGINT, SIGTERM and SIGHUP end the process in order: what is being written is
/// removed, older results stay, and the exit code is 128 and the signal's number (130, 143, 129). A
/// thread waits for them, so that no handler runs in between and long work needs no checks. Signals
/// that the caller has the process ignore stay ignored. A file that grows beyond its limit
/// (SIGXFSZ) and a pipe that nobody reads any more (SIGPIPE) become errors of the write. Call
/// before any other thread is started.
void endInOrderOnSignals() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGCHLD, SIG_DFL);  // some daemons ignore it, and then no child can be waited for
  sigset_t awaited;
  sigemptyset(&awaited);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (!isIgnored(signal)) sigaddset(&awaited, signal);
  }
  pthread_sigmask(SIG_BLOCK, &awaited, nullptr);
  std::thread(endOn, awaited).detach();
}

/// Returns unless a signal is ending the process: then what fails, fails for that reason, and there
/// is nothing to be said of it.
void waitIfEnding() {
  while (ending) pause();
}

std::vector<Command> commands() {
  return {simulateCommand(), importCommand(),     detectCommand(),   calibrateCommand(),
          evaluateCommand(), compareCommand(),    odometryCommand(), exportCommand(),
          targetCommand(),   perturbCommand(),    replayCommand(),   studyCommand(),
          reportCommand(),   completionCommand(), manCommand()};
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
  static const std::map<InputFault, std::string> kOptions{
      {InputFault::kNoTarget, "; give it with --target FILE"},
      {InputFault::kNoResolution, "; give it with --resolution WxH"},
      {InputFault::kNoCorners, "; run plumbline detect on it first"},
      {InputFault::kNoImuNoise, "; give its noise densities with --imu imu.yaml"},
      {InputFault::kNoImuSamples, "; or ignore the IMU with --no-imu"},
      {InputFault::kResultExists, "; replace it with --force"},
      {InputFault::kNoCache, "; choose another with --cache DIR, or none with --no-cache"},
      {InputFault::kNothingSelected, "; correct --from and --to"},
      {InputFault::kUnsupportedModel, "; choose it with --models"},
      {InputFault::kUnknownCamera, "; correct --only"},
      {InputFault::kTooManyCameras, "; choose cameras with --only, e.g. --only cam0,cam1"},
      {InputFault::kBadCameraRate, "; correct --camera-rate"},
      {InputFault::kSeveralImus, "; name it with --imu-topic"}};
  const auto found = kOptions.find(code);
  return found == kOptions.end() ? "" : found->second;
}

// The same, where the command has the option.
std::string adviceFor(InputFault code, const CLI::App& command) {
  const std::string advice = optionFor(code);
  const auto at = advice.find("--");
  if (at == std::string::npos) return advice;
  // Where an advice names several options, the first one stands for the command having them.
  const std::string option = advice.substr(at, advice.find_first_of(" ,", at) - at);
  return command.get_option_no_throw(option) != nullptr ? advice : "";
}

// Where a signal ends the process, what fails does so for that reason.
int failed(std::string message, int exit_code) {
  waitIfEnding();
  complain(withFinalNames(std::move(message)));
  return exit_code;
}

// Names go into documents, which are UTF-8.
void refuseOtherThanUtf8(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (isUtf8(argv[i])) continue;
    throw InputError(argv[i], 0,
                     "is not UTF-8; expected a name in UTF-8; rename it, or link to it");
  }
}

int runChosen(const CLI::App& app, const std::function<int()>& chosen) {
  try {
    return chosen();
  } catch (const InputErrors& errors) {  // ahead of InputError, of which it and BadInput are kinds
    for (const InputError& error : errors.all()) failed(error.what(), kBadInput);
    return kBadInput;
  } catch (const BadInput& error) {
    return failed(error.what() + adviceFor(error.code(), chosenCommand(app)), kBadInput);
  } catch (const InputError& error) {
    return failed(error.what(), kBadInput);
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(fmt::format("{}: {}; check the path and its permissions", error.path1().string(),
                              error.code().message()),
                  kBadInput);
  } catch (const std::exception& error) {
    return failed(fmt::format("unexpected failure: {}", error.what()), kFailed);
  }
}

// Big arrays go back to the system as soon as they are freed. Left alone, glibc raises this limit
// with the first big array that is freed, keeps the later ones on its heap, and the peak grows by a
// quarter (127 against 102 MB for both stages of a stereo recording of 72 s).
void returnFreedArrays() { mallopt(M_MMAP_THRESHOLD, 256 * 1024); }

}  // namespace

int runProgram(int argc, char** argv) {
  returnFreedArrays();
  keepCommandLine({argv, argv + argc});
  // Before any file is opened, which would take the place of a stream that is closed; and the
  // signals before any other thread, all of which inherit that they are blocked.
  occupyStandardStreams();
  endInOrderOnSignals();
  CLI::App app{
      "Calibrate camera-IMU rigs from recordings of an AprilGrid, and evaluate calibrations.",
      "plumbline"};
  app.set_version_flag("--version", programVersion());
  app.require_subcommand(1);
  const std::function<int()> chosen = addCommands(app, commands());
  try {
    refuseOtherThanUtf8(argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // help, version
      app.exit(error);
      return closeOutput() ? kDone : kFailed;
    }
    return failed(fmt::format("{}{}; see plumbline{} --help", usageText(error, app),
                              didYouMean(app), chosenWords(app)),
                  kBadInput);
  } catch (const InputError& error) {
    return failed(error.what(), kBadInput);
  }
  const int exit_code = runChosen(app, chosen);
  // Output that could not be written is a failure, unless there is a code that says more.
  return closeOutput() || exit_code != kDone ? exit_code : kFailed;
}

}  // namespace plumbline
