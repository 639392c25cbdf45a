// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/program.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "calibrator/base/time.h"
#include "datasets/files/shown_text.h"

namespace plumbline {
namespace {

constexpr int kNoProgram = 127;  // as a shell has it
constexpr std::size_t kLongestLine = 300;

std::vector<std::string> environmentOf(const ProgramRequest& request) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (request.environment.count(text.substr(0, text.find('='))) == 0) all.push_back(text);
  }
  for (const auto& [name, value] : request.environment) all.push_back(name + "=" + value);
  return all;
}

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// In the child: only calls that are safe between fork and exec of a program with threads.
[[noreturn]] void become(char* const* words, char* const* environment, const char* folder, int log,
                         std::size_t memory_bytes) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (memory_bytes > 0) {
    const rlimit limit{memory_bytes, memory_bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  const int nothing = open("/dev/null", O_RDONLY);
  if (chdir(folder) != 0 || dup2(nothing, 0) < 0 || dup2(log, 1) < 0 || dup2(log, 2) < 0) {
    _exit(kNoProgram);
  }
  execvpe(words[0], words, environment);
  _exit(kNoProgram);
}

}  // namespace

ProgramEnd runProgram(const ProgramRequest& request) {
  std::vector<std::string> words = request.words, environment = environmentOf(request);
  const std::vector<char*> argv = pointersTo(words), envp = pointersTo(environment);
  const int log =
      open(request.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_APPEND, 0644);
  if (log < 0) throw InputError(request.log.string(), 0, std::strerror(errno));
  const Stopwatch clock;
  const pid_t child = fork();
  if (child < 0) {
    close(log);
    throw InputError(request.words.front(), 0, std::strerror(errno));
  }
  if (child == 0) {
    become(argv.data(), envp.data(), request.folder.c_str(), log, request.memory_bytes);
  }
  close(log);
  setpgid(child, child);  // also here: it may not have come to it yet
  ProgramEnd end;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (!end.timed_out && clock.seconds() > request.seconds) {
      end.timed_out = true;
      kill(-child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(-child, SIGKILL);  // what it has left behind
  end.seconds = clock.seconds();
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  end.started = end.exit_code != kNoProgram;
  return end;
}

std::string toString(const ProgramEnd& end) {
  if (end.timed_out) return fmt::format("no end within {:.0f} s", end.seconds);
  if (!end.started) return "could not be started (exit code 127)";
  if (end.signal != 0) {
    return fmt::format("killed by signal {} ({})", end.signal, strsignal(end.signal));
  }
  return fmt::format("exit code {}", end.exit_code);
}

std::vector<std::string> lastLinesOf(const std::filesystem::path& file, std::size_t count) {
  std::ifstream stream(file);
  std::deque<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(shownLine(line.substr(0, kLongestLine)));
    if (lines.size() > count) lines.pop_front();
  }
  return {lines.begin(), lines.end()};
}

}  // namespace plumbline
