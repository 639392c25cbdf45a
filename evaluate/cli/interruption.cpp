// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/interruption.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <thread>

#include <fmt/core.h>
#include <unistd.h>

#include "datasets/files/workplace.h"

namespace plumbline {
namespace {

std::atomic<bool> ending{false};

[[noreturn]] void endOn(sigset_t awaited) {
  int signal = 0;
  while (sigwait(&awaited, &signal) != 0) {
  }
  ending = true;
  abandonWorkplaces();
  const char* clear = isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "";
  fmt::print(stderr, "{}plumbline: stopped by signal {}; what was unfinished is removed\n", clear,
             signal);
  _exit(128 + signal);
}

bool isIgnored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void endInOrderOnSignals() {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond its limit is an error of the write
  sigset_t awaited;
  sigemptyset(&awaited);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (!isIgnored(signal)) sigaddset(&awaited, signal);
  }
  pthread_sigmask(SIG_BLOCK, &awaited, nullptr);
  std::thread(endOn, awaited).detach();
}

void waitIfEnding() {
  while (ending) pause();
}

}  // namespace plumbline
