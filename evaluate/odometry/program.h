// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace plumbline {

struct ProgramRequest {
  std::vector<std::string> words;  ///< the program, found by PATH, and its arguments
  std::filesystem::path folder;    ///< where it runs
  std::map<std::string, std::string> environment;  ///< beside the caller's
  std::filesystem::path log;                       ///< takes its standard output and error
  double seconds = 3600;                           ///< of wall time; then its group is killed
  std::size_t memory_bytes = 0;                    ///< of address space; 0: no limit
};

/// How a process ended.
struct ProgramEnd {
  bool started = false;  ///< false: no such program
  bool timed_out = false;
  int exit_code = -1;  ///< -1 where a signal ended it
  int signal = 0;
  double seconds = 0;

  bool ok() const { return started && !timed_out && exit_code == 0; }
};

/// Runs a program in a process group of its own and waits for it; whatever is left of the group
/// after that, or after the time limit, is killed. Throws InputError where the log cannot be
/// written or no process can be made.
ProgramEnd runProgram(const ProgramRequest& request);

/// "exit code 3", "killed by signal 11 (Segmentation fault)", "no end within 60 s".
std::string toString(const ProgramEnd& end);

/// The last `count` lines of a file, each cut at 300 bytes; none where it cannot be read.
std::vector<std::string> lastLinesOf(const std::filesystem::path& file, std::size_t count);

}  // namespace plumbline
