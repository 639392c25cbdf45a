// SPDX-License-Identifier: BSD-3-Clause
// Other programs: how they end, their limits, what they are given, and that nothing of them stays.
#include "evaluate/process/process.h"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

class Process : public testing::Test {
 protected:
  ProcessEnd run(const std::string& script, ProcessRequest request = {}) {
    request.words = {"sh", "-c", script};
    request.log = log_;
    return runProcess(request);
  }
  std::string log() const {
    std::ifstream file(log_);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  // This program, in order: it runs the script until it gets SIGTERM, and then ends it.
  ProcessRequest thisProgramWith(const std::string& script) const {
    ProcessRequest request;
    request.words = {kRunningProgram, "--gtest_also_run_disabled_tests",
                     "--gtest_filter=ThisProgram.DISABLED_RunsAScriptUntilSigterm"};
    request.environment = {{"PLUMBLINE_TEST_SCRIPT", script}};
    request.log = log_;
    return request;
  }
  // Beyond its time. Where it was over before the program wrote the file, which is what it is to be
  // ended at, it gets twice as long: on an idle machine the first limit is ample.
  static ProcessEnd runBeyondTime(ProcessRequest request, const std::filesystem::path& started) {
    for (request.limit_s = 0.5;; request.limit_s *= 2) {
      const ProcessEnd end = runProcess(request);
      if (std::filesystem::exists(started) || request.limit_s > 60) return end;
    }
  }
  // Within 2 s; init reaps it.
  static bool ends(pid_t pid) {
    for (int i = 0; i < 200 && kill(pid, 0) == 0; ++i) {
      std::ifstream state("/proc/" + std::to_string(pid) + "/stat");
      std::string number, name, letter;
      if (!(state >> number >> name >> letter) || letter == "Z") return true;
      usleep(10'000);
    }
    return kill(pid, 0) != 0;
  }

  void SetUp() override {
    std::string pattern = testing::TempDir() + "plumbline_process_XXXXXX";
    scratch_ = mkdtemp(pattern.data());
    log_ = scratch_ / "log.txt";
  }
  void TearDown() override { std::filesystem::remove_all(scratch_); }

  std::filesystem::path scratch_, log_;
};

// No test, but what Process::thisProgramWith() runs. Without a script it ignores SIGTERM.
TEST(ThisProgram, DISABLED_RunsAScriptUntilSigterm) {
  sigset_t awaited;
  sigemptyset(&awaited);
  sigaddset(&awaited, SIGTERM);
  sigprocmask(SIG_BLOCK, &awaited, nullptr);
  const char* script = std::getenv("PLUMBLINE_TEST_SCRIPT");
  ASSERT_NE(script, nullptr);
  if (*script == '\0') {
    std::ofstream(std::getenv("PLUMBLINE_TEST_STARTED")) << "started";
    pause();
  }
  ProcessRequest request;
  request.words = {"sh", "-c", script};
  request.log = "/dev/null";
  const ChildProcess child(request);
  int signal = 0;
  sigwait(&awaited, &signal);
  killChildren();
  _exit(0);
}

TEST_F(Process, TellsExitCodeSignalAndWhatItPrinted) {
  const ProcessEnd three = run("echo out; echo err >&2; exit 3");
  EXPECT_EQ(three.exit_code, 3);
  EXPECT_FALSE(three.ok());
  EXPECT_EQ(toString(three), "exit code 3");
  EXPECT_EQ(log(), "out\nerr\n");
  const ProcessEnd killed = run("kill -SEGV $$");
  EXPECT_EQ(killed.exit_code, -1);
  EXPECT_EQ(killed.signal, SIGSEGV);
  EXPECT_THAT(toString(killed), testing::HasSubstr("signal 11"));
  EXPECT_TRUE(run("true").ok());
}

TEST_F(Process, AProgramHasItsThreeStreamsAndNoMoreOfOurs) {
  // The two lowest that are free: the log's, then that of its standard input.
  const int first = dup(STDIN_FILENO), second = dup(STDIN_FILENO);
  close(first), close(second);
  run("exec readlink /proc/self/fd/0 /proc/self/fd/" + std::to_string(second));
  EXPECT_EQ(log(), "/dev/null\n");
}

TEST_F(Process, AProgramThatIsNotThereDoesNotPassForOneThatSucceeded) {
  ProcessRequest request;
  request.words = {"no-such-program-of-plumbline"};
  request.log = log_;
  const ProcessEnd end = runProcess(request);
  EXPECT_EQ(end.exit_code, kNoProgram);
  EXPECT_FALSE(end.ok());
  EXPECT_THAT(toString(end), testing::HasSubstr("could not be started"));
}

TEST_F(Process, HasTheFolderAndTheEnvironmentItIsGivenAndNoInput) {
  ProcessRequest request;
  request.folder = scratch_;
  request.environment = {{"PLUMBLINE_TEST", "given"}};
  ASSERT_TRUE(run("pwd; echo $PLUMBLINE_TEST; cat; test -n \"$PATH\"", request).ok());
  EXPECT_EQ(log(), std::filesystem::canonical(scratch_).string() + "\ngiven\n");
  request.folder = scratch_ / "missing";
  EXPECT_FALSE(run("true", request).ok());
}

TEST_F(Process, AProgramDoesNotIgnoreTheSignalsThatWeIgnore) {
  for (const int number : {SIGPIPE, SIGXFSZ}) {
    const auto before = std::signal(number, SIG_IGN);
    EXPECT_EQ(run("kill -" + std::to_string(number) + " $$").signal, number);
    std::signal(number, before);
  }
}

TEST_F(Process, BeyondItsTimeItIsKilledWithAllItStarted) {
  ProcessRequest request;
  request.limit_s = 1;
  const ProcessEnd end = run("sleep 60 & echo $!; wait", request);
  EXPECT_TRUE(end.beyond_time);
  EXPECT_FALSE(end.ok());
  EXPECT_TRUE(ends(static_cast<pid_t>(std::stol(log()))));
}

// With descendants: also what has left its group and its parents, whatever its program's end.
TEST_F(Process, NothingIsLeftOfAProgramThatEndsWithItsDescendants) {
  ProcessRequest request;
  request.with_descendants = true;
  const std::string leaves = "setsid sh -c 'setsid sleep 60 & echo $!; setsid sleep 60 & echo $!' ";
  const auto left = [&] {
    std::ifstream file(log_);
    const std::vector<pid_t> ids{std::istream_iterator<pid_t>(file), {}};
    std::filesystem::remove(log_);
    return ids;
  };
  EXPECT_EQ(run(leaves + "; exit 3", request).exit_code, 3);
  std::vector<pid_t> ids = left();
  EXPECT_EQ(run(leaves + "; kill -SEGV $$", request).signal, SIGSEGV);
  const std::vector<pid_t> more = left();
  ids.insert(ids.end(), more.begin(), more.end());
  request.limit_s = 1;
  const ProcessEnd late = run(leaves + "& wait; sleep 60", request);
  EXPECT_TRUE(late.beyond_time);
  EXPECT_LT(late.seconds, 5);
  const std::vector<pid_t> last = left();
  ids.insert(ids.end(), last.begin(), last.end());
  EXPECT_EQ(ids.size(), 6U);
  for (const pid_t id : ids) EXPECT_TRUE(ends(id)) << id;
}

// As a time limit of a cluster ends this process, which can end nothing in order then.
TEST_F(Process, WhereThisProcessIsKilledDescendantsEndToo) {
  const std::filesystem::path started = scratch_ / "started";
  const pid_t killed = fork();
  if (killed == 0) {
    ProcessRequest request;
    request.words = {"sh", "-c",
                     "sleep 60 & setsid sleep 60 & echo $! > " + started.string() + ".part; mv " +
                         started.string() + ".part " + started.string() + "; wait"};
    request.log = log_;
    request.with_descendants = true;
    (void)runProcess(request);
    _exit(0);
  }
  while (!std::filesystem::exists(started)) usleep(10'000);
  kill(killed, SIGKILL);
  waitpid(killed, nullptr, 0);
  pid_t left = 0;
  ASSERT_TRUE(std::ifstream(started) >> left);
  EXPECT_TRUE(ends(left));
}

// It alone knows what it runs: SIGKILL at once would leave what the script has started.
TEST_F(Process, BeyondItsTimeThisProgramEndsInOrder) {
  const std::filesystem::path started = scratch_ / "started";
  const ProcessEnd end =
      runBeyondTime(thisProgramWith("sleep 60 & echo $! > " + started.string() + ".part; mv " +
                                    started.string() + ".part " + started.string() + "; wait"),
                    started);
  EXPECT_TRUE(end.beyond_time);
  EXPECT_EQ(end.exit_code, 0);
  pid_t left = 0;
  ASSERT_TRUE(std::ifstream(started) >> left);
  EXPECT_TRUE(ends(left));
}

TEST_F(Process, WhereThisProgramDoesNotEndInOrderItIsKilled) {
  const std::filesystem::path started = scratch_ / "started";
  ProcessRequest request = thisProgramWith("");
  request.environment["PLUMBLINE_TEST_STARTED"] = started.string();
  request.to_end_s = 1;
  const ProcessEnd end = runBeyondTime(request, started);
  EXPECT_TRUE(end.beyond_time);
  EXPECT_EQ(end.signal, SIGKILL);
  EXPECT_GT(end.seconds, 1.5);  // its limit, and its time to end
}

// As a signal ends this process: nothing writes on while it removes what was being made.
TEST_F(Process, OnASignalChildrenEndWithAllThatTheyStarted) {
  const std::filesystem::path started = scratch_ / "started", late = scratch_ / "late";
  const pid_t ending = fork();
  if (ending == 0) {
    ProcessRequest request;
    request.words = {
        "sh", "-c",
        "(sleep 1; echo > " + late.string() + ") & echo > " + started.string() + "; wait"};
    request.log = log_;
    const ChildProcess child(request);
    while (!std::filesystem::exists(started)) usleep(10'000);
    killChildren();
    _exit(0);
  }
  waitpid(ending, nullptr, 0);
  ASSERT_TRUE(std::filesystem::exists(started));
  usleep(1'500'000);
  EXPECT_FALSE(std::filesystem::exists(late));
}

// A child that is stopped (SIGSTOP) takes no other signal: this process would wait for ever.
TEST_F(Process, OnASignalAChildThatIsStoppedEndsInOrder) {
  const std::filesystem::path started = scratch_ / "started";
  const pid_t ending = fork();
  if (ending == 0) {
    alarm(60);
    const ChildProcess child(
        thisProgramWith("sleep 60 & kill -STOP $PPID; echo $! > " + started.string() + "; wait"));
    while (!std::filesystem::exists(started)) usleep(10'000);
    usleep(200'000);
    killChildren();
    _exit(0);
  }
  int status = 0;
  waitpid(ending, &status, 0);
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  pid_t left = 0;
  ASSERT_TRUE(std::ifstream(started) >> left);
  EXPECT_TRUE(ends(left));
}

TEST_F(Process, BeyondItsMemoryAnAllocationFails) {
  ProcessRequest request;
  request.limit_mb = 64;
  const std::string big = "head -c 200000000 /dev/zero | tail -c 150000000 | wc -c";
  EXPECT_TRUE(run(big).ok());
  EXPECT_THAT(log(), testing::HasSubstr("150000000"));
  std::filesystem::remove(log_);
  (void)run(big, request);
  EXPECT_THAT(log(), testing::Not(testing::HasSubstr("150000000")));
}

TEST_F(Process, ALogThatCannotBeWrittenIsRefused) {
  ProcessRequest request;
  request.words = {"true"};
  request.log = scratch_ / "missing" / "log.txt";
  EXPECT_THROW(runProcess(request), InputError);
}

}  // namespace
}  // namespace plumbline
