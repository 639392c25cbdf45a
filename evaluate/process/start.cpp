// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/process/start.h"

#include <csignal>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace plumbline {
namespace {

/// Soft and hard limit alike: the child cannot raise it again.
void limitTo(int resource, rlim_t value) {
  const rlimit limit{value, value};
  (void)setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

void takeAllSignals() {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// All children of this process, of one thread, and what becomes its children as they end. Where
/// the system does not list them (CONFIG_PROC_CHILDREN), none.
void killDescendants() {
  for (;;) {
    while (waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    char list[4096];
    const int file = open("/proc/thread-self/children", O_RDONLY | O_CLOEXEC);
    const ssize_t size = read(file, list, sizeof list);
    close(file);
    if (size <= 0) return;
    pid_t id = 0;
    // Each has a blank behind it; one that is cut off is read in the next round.
    for (ssize_t i = 0; i < size; ++i) {
      if (list[i] != ' ') {
        id = 10 * id + (list[i] - '0');
        continue;
      }
      kill(id, SIGKILL);
      id = 0;
    }
    poll(nullptr, 0, kPollMs);
  }
}

}  // namespace

void endWith(pid_t parent, int last) {
  signal(SIGTERM, SIG_DFL);
  // By Linux the parent is the thread that forked: it has to live as long as the child shall.
  prctl(PR_SET_PDEATHSIG, last);
  if (getppid() != parent) _exit(126);  // it died before the line above
  setpgid(0, 0);
  limitTo(RLIMIT_CORE, 0);
}

void become(const Start& start) {
  const ProcessRequest& request = start.request;
  takeAllSignals();
  // What this process ignores would stay ignored in the program.
  signal(SIGXFSZ, SIG_DFL);
  signal(SIGPIPE, SIG_DFL);
  const int nothing = open("/dev/null", O_RDONLY);
  if (dup2(nothing, STDIN_FILENO) < 0 || dup2(start.log, STDOUT_FILENO) < 0 ||
      dup2(start.log, STDERR_FILENO) < 0) {
    _exit(126);
  }
  if (nothing > STDERR_FILENO) close(nothing);  // the program has it as its input
  // 126: what a shell returns for a program that it found and could not run.
  if (!request.folder.empty() && chdir(request.folder.c_str()) != 0) _exit(126);
  if (request.limit_mb > 0) limitTo(RLIMIT_AS, static_cast<rlim_t>(request.limit_mb) << 20);
  execvpe(start.words[0], start.words, start.environment);
  _exit(kNoProgram);
}

void watchOver(const Start& start) {
  sigset_t awaited;
  sigemptyset(&awaited);
  sigaddset(&awaited, SIGTERM);
  sigaddset(&awaited, SIGCHLD);
  sigprocmask(SIG_BLOCK, &awaited, nullptr);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t self = getpid();
  const pid_t program = fork();
  if (program == 0) {
    endWith(self, SIGKILL);
    become(start);
  }
  if (program < 0) _exit(126);
  setpgid(program, program);
  (void)syscall(SYS_close_range, 3, ~0U, 0);  // locks and pipes: they end with whom they belong to
  int status = 0;
  for (pid_t ended = 0; ended != program;) {
    ended = waitpid(-1, &status, WNOHANG);
    if (ended == 0 && sigwaitinfo(&awaited, nullptr) == SIGTERM) kill(-program, SIGKILL);
  }
  kill(-program, SIGKILL);
  killDescendants();
  if (WIFEXITED(status)) _exit(WEXITSTATUS(status));
  takeAllSignals();
  signal(WTERMSIG(status), SIG_DFL);
  kill(self, WTERMSIG(status));
  _exit(126);
}

}  // namespace plumbline
