// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include "evaluate/process/process.h"

namespace plumbline {

/// What a child does from fork to exec or _exit: only what may be called in a signal handler, as
/// the process that forked may have threads.

/// What a program is started with; made before fork, since between fork and exec nothing may
/// allocate.
struct Start {
  const ProcessRequest& request;
  char* const* words;
  char* const* environment;
  int log;
};

/// The first of a child: it gets `last` where its parent ends.
void endWith(pid_t parent, int last);

/// Is the program from here on.
[[noreturn]] void become(const Start& start);

/// Runs the program and ends as it did, when nothing of it is left; on SIGTERM it ends it.
[[noreturn]] void watchOver(const Start& start);

/// Where the system does not say when a child ends, it is asked for this often.
inline constexpr int kPollMs = 5;

}  // namespace plumbline
