// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace plumbline {

/// A program to run.
struct ProcessRequest {
  std::vector<std::string> words;  ///< the program, found by PATH where it has no slash; arguments
  std::filesystem::path log;       ///< standard output and error are appended to it
  std::filesystem::path folder;    ///< where it runs; empty: here
  std::map<std::string, std::string> environment;  ///< beside the caller's
  double limit_s = 0;                              ///< wall time; 0: none
  int limit_mb = 0;                                ///< address space (RLIMIT_AS); 0: none
  bool with_descendants = false;  ///< what it has started ends with it in any case: ChildProcess
  double to_end_s = 10;           ///< beyond its time: from its last signal to SIGKILL
};

/// What a shell says where there is no such program.
inline constexpr int kNoProgram = 127;

/// How it ended.
struct ProcessEnd {
  int exit_code = -1;  ///< -1: by a signal
  int signal = 0;
  bool beyond_time = false;
  double seconds = 0, cpu_s = 0, peak_mb = 0;

  bool ok() const { return !beyond_time && exit_code == 0; }
};

/// "exit code 3", "killed by signal 11 (Segmentation fault)", "did not end within 60 s".
std::string toString(const ProcessEnd& end);

/// A child in a process group of its own, that ends with this process, however that ends. What it
/// has started itself ends with it where this process ends or reaps it, or where it is this program
/// (kRunningProgram), which gets SIGTERM and ends in order, and SIGKILL only where it has not
/// within 10 s; not where SIGKILL ends this process and it is another, nor what leaves its group
/// (setsid). With with_descendants it does then, too: a process of ours stands between, to which
/// all that the program leaves becomes a child, and which ends it with the program or with this
/// process (but where it gets SIGKILL itself). Its signal mask is empty, it does not ignore
/// SIGTERM, SIGPIPE and SIGXFSZ as this process may, and it leaves no core file.
class ChildProcess {
 public:
  /// Throws InputError where it cannot be started.
  explicit ChildProcess(const ProcessRequest& request);
  ~ChildProcess();  ///< ends the group, if it still runs; waits up to 20 s
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits up to `seconds`; empty: it still runs. What is beyond its time is ended.
  std::optional<ProcessEnd> waitFor(double seconds);

  /// Returns when one of them may have ended, or after `seconds`.
  static void waitForAny(const std::vector<ChildProcess*>& children, double seconds);

 private:
  std::optional<ProcessEnd> ended();
  double endsAtS() const;  // when it gets its last signal, and after it SIGKILL
  void endBeyondTime();

  pid_t pid_ = -1;
  int descriptor_ = -1;  // of the process, to wait on
  double limit_s_ = 0, to_end_s_ = 0;
  double started_s_ = 0;
  bool beyond_time_ = false;
};

/// Runs it to its end.
ProcessEnd runProcess(const ProcessRequest& request);

/// Ends every child of this process with its group, within 20 s, and lets none be started or waited
/// for any more: calls that would wait for ever. For the thread that ends the process on a signal,
/// before it removes what they write (abandonWorkplaces()).
void killChildren();

/// This program's file, for commands that others run.
std::string thisProgram();
/// The program that runs now, whatever stands under its name by then.
inline constexpr const char* kRunningProgram = "/proc/self/exe";

}  // namespace plumbline
