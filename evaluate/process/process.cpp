// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/process/process.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
#include "evaluate/process/start.h"

namespace plumbline {
namespace {

// So long may a child take to end after its last signal, before it gets SIGKILL, where it is ended
// with this process or with its ChildProcess.
constexpr double kToEndS = 10;

/// Those that were started and not yet reaped: by the mutex none of their ids is another process's.
struct Children {
  std::mutex mutex;
  std::map<pid_t, int> ids;  // and the signal that ends each with this process
};

/// Never destroyed: killChildren() leaves its mutex locked.
Children& children() {
  static auto* const all = new Children;
  return *all;
}

double nowS() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

double secondsOf(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// This program ends in order, with what it runs itself (killChildren()), and so does watchOver();
/// others leave that running.
int lastSignalOf(const ProcessRequest& request) {
  return request.with_descendants || request.words[0] == kRunningProgram ? SIGTERM : SIGKILL;
}

/// To a child's group. One that is stopped (SIGSTOP) would see no signal but SIGKILL: it goes on.
void signalGroup(pid_t id, int signal) {
  kill(-id, signal);
  kill(-id, SIGCONT);
}

/// Reaps these as they end, for kToEndS at most; returns those that have not ended.
std::map<pid_t, int> reap(std::map<pid_t, int> ids) {
  const double until = nowS() + kToEndS;
  for (;;) {
    std::erase_if(ids,
                  [](const auto& child) { return waitpid(child.first, nullptr, WNOHANG) != 0; });
    if (ids.empty() || nowS() > until) return ids;
    poll(nullptr, 0, kPollMs);
  }
}

/// Ends children with their groups, by the signal of each, and by SIGKILL what does not end by it.
void endGroups(const std::map<pid_t, int>& ids) {
  for (const auto& [id, signal] : ids) signalGroup(id, signal);
  const std::map<pid_t, int> left = reap(ids);
  for (const auto& [id, signal] : left) kill(-id, SIGKILL);
  (void)reap(left);  // not for ever: even SIGKILL waits for a file system that does not answer
}

/// The caller's variables but those that the request sets.
std::vector<std::string> environmentOf(const ProcessRequest& request) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (request.environment.count(text.substr(0, text.find('='))) == 0) all.push_back(text);
  }
  for (const auto& [name, value] : request.environment) all.push_back(name + "=" + value);
  return all;
}

/// As exec wants them.
std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

ChildProcess::ChildProcess(const ProcessRequest& request)
    : limit_s_(request.limit_s), to_end_s_(request.to_end_s), started_s_(nowS()) {
  // Appended to: several programs may share a log, and standard output and error do.
  const int log = open(request.log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (log < 0) {
    throw badInput(request.log.string(),
                   {InputFault::kUnwritable, std::strerror(errno), "a file that can be written"});
  }
  std::vector<std::string> words = request.words, environment = environmentOf(request);
  const std::vector<char*> argv = pointersTo(words), envp = pointersTo(environment);
  const Start start{request, argv.data(), envp.data(), log};
  const pid_t parent = getpid();
  const std::lock_guard guard(children().mutex);
  pid_ = fork();
  if (pid_ == 0) {
    endWith(parent, lastSignalOf(request));
    request.with_descendants ? watchOver(start) : become(start);
  }
  const int error = errno;
  close(log);
  if (pid_ < 0) {
    throw badInput(request.words[0], {InputFault::kOther, std::string("cannot be started (") +
                                                              std::strerror(error) + ")"});
  }
  children().ids[pid_] = lastSignalOf(request);
  setpgid(pid_, pid_);  // here too: whoever kills the group next finds it
  // Linux 5.3 and later; -1 before: then waitFor() polls.
  descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    const std::lock_guard guard(children().mutex);
    const auto child = children().ids.find(pid_);
    endGroups({*child});
    children().ids.erase(child);
  }
  if (descriptor_ >= 0) close(descriptor_);
}

std::optional<ProcessEnd> ChildProcess::ended() {
  int status = 0;
  // wait4() gives the child's own figures, with those of the descendants that it waited for.
  struct rusage used {};
  const std::lock_guard guard(children().mutex);
  if (wait4(pid_, &status, WNOHANG, &used) != pid_) return std::nullopt;
  kill(-pid_, SIGKILL);  // what it left running
  children().ids.erase(pid_);
  pid_ = -1;
  ProcessEnd end;
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  end.beyond_time = beyond_time_;
  end.seconds = nowS() - started_s_;
  end.cpu_s = secondsOf(used.ru_utime) + secondsOf(used.ru_stime);
  // ru_maxrss is in kilobytes on Linux.
  end.peak_mb = static_cast<double>(used.ru_maxrss) / 1024;
  return end;
}

double ChildProcess::endsAtS() const {
  if (limit_s_ <= 0) return std::numeric_limits<double>::infinity();
  return started_s_ + limit_s_ + (beyond_time_ ? to_end_s_ : 0);
}

void ChildProcess::endBeyondTime() {
  const std::lock_guard guard(children().mutex);
  signalGroup(pid_, beyond_time_ ? SIGKILL : children().ids.at(pid_));
  beyond_time_ = true;
}

std::optional<ProcessEnd> ChildProcess::waitFor(double seconds) {
  const double until = nowS() + seconds;
  for (;;) {
    if (const auto end = ended()) return end;
    const double now = nowS();
    // It ends on a later turn; beyond_time_ says why.
    if (now > endsAtS()) endBeyondTime();
    if (now >= until) return std::nullopt;
    double pause = until - now;
    if (endsAtS() > now) pause = std::min(pause, endsAtS() - now);
    // Rounded up, so that a limit is over when the wait for it is.
    const int ms = std::clamp(static_cast<int>(1e3 * pause) + 1, 1, 60000);
    if (descriptor_ >= 0) {
      pollfd waiting{descriptor_, POLLIN, 0};
      poll(&waiting, 1, ms);
    } else {
      poll(nullptr, 0, std::min(ms, kPollMs));
    }
  }
}

void ChildProcess::waitForAny(const std::vector<ChildProcess*>& children, double seconds) {
  std::vector<pollfd> waiting;
  int ms = std::max(1, static_cast<int>(1e3 * seconds));
  for (const ChildProcess* child : children) {
    if (child->descriptor_ < 0) ms = std::min(ms, kPollMs);
    waiting.push_back({child->descriptor_, POLLIN, 0});  // poll() passes over negative ones
  }
  poll(waiting.data(), waiting.size(), ms);
}

ProcessEnd runProcess(const ProcessRequest& request) {
  ChildProcess child(request);
  for (;;) {
    if (const auto end = child.waitFor(3600)) return *end;
  }
}

void killChildren() {
  children().mutex.lock();  // and never unlocked: see the header
  endGroups(children().ids);
}

std::string toString(const ProcessEnd& end) {
  if (end.beyond_time) return fmt::format("did not end within {:.0f} s", end.seconds);
  if (end.exit_code == kNoProgram) {
    return "it, or a program that it runs, could not be started (exit code 127)";
  }
  if (end.signal != 0) {
    return fmt::format("killed by signal {} ({})", end.signal, strsignal(end.signal));
  }
  return fmt::format("exit code {}", end.exit_code);
}

std::string thisProgram() { return std::filesystem::read_symlink(kRunningProgram).string(); }

}  // namespace plumbline
