// SPDX-License-Identifier: BSD-3-Clause
// The output contract as a user meets it: killed at any call, on a full disk, by a signal, beside
// siblings, an older or the new result is there whole, and nothing else.
#include <cerrno>
#include <chrono>
#include <csignal>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const fs::path kOutputConfigs = fs::path(PLUMBLINE_SOURCE_DIR) / "third_party_configs";

/// The program with calls that fail (tests/shim), once for every call it makes.
class FailingCalls : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() / ("plumbline_failing_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  }
  void TearDown() override { fs::remove_all(root_); }

  fs::path out() const { return root_ / "parent/out"; }
  static std::string command(const std::string& words) {
    const std::string source = (kOutputConfigs / "source/calibration.json").string();
    if (words == "export") return "export " + source + " --to vins-fusion";
    return "compare " + source + " " + (kOutputConfigs / "kalibr/camchain-imucam.yaml").string() +
           " --no-report --no-cache --grid 3x3 --focus-radius 500";
  }
  Outcome run(const std::string& words, const std::string& environment = "") const {
    const std::string preload =
        environment.empty() ? "" : std::string("LD_PRELOAD=") + PLUMBLINE_FAILING_CALLS + " ";
    return shell("ASAN_OPTIONS=verify_asan_link_order=0 " + preload + environment + " " +
                 PLUMBLINE_BINARY + " " + words + " --out " + out().string());
  }
  struct Counts {
    long changes = 0, writes = 0;
  };
  Counts countsOf(const std::string& words) const {
    const fs::path file = root_ / "counts";
    EXPECT_EQ(run(words, "PLUMBLINE_COUNTS=" + file.string()).exit_code, 0);
    Counts counts;
    std::istringstream(read(file)) >> counts.changes >> counts.writes;
    EXPECT_GT(counts.changes, 10);
    EXPECT_GT(counts.writes, 2);
    return counts;
  }
  // Whole by its own manifest: every file is there as it was written, and nothing else.
  static bool isWhole(const fs::path& folder) {
    const auto manifest = nlohmann::json::parse(read(folder / "plumbline.json"));
    std::map<std::string, std::uint64_t> sizes;
    for (const auto& [name, entry] : manifest["files"].items()) sizes[name] = entry["bytes"];
    std::map<std::string, std::uint64_t> found;
    for (const auto& [name, text] : contents(folder)) found[name] = text.size();
    return sizes == found;
  }
  std::size_t entriesBeside() const {
    std::size_t entries = 0;
    if (!fs::exists(out().parent_path())) return 0;
    for (const auto& entry : fs::directory_iterator(out().parent_path())) {
      entries += entry.path() == out() ? 0 : 1;
    }
    return entries;
  }

  /// All files and folders about the output, for a message.
  std::string namesBeside() const {
    std::string names;
    std::error_code gone;
    for (const auto& entry : fs::recursive_directory_iterator(out().parent_path(), gone)) {
      names += "\n" + entry.path().string();
    }
    return names;
  }

  fs::path root_;
};

class KilledAnywhere : public FailingCalls, public testing::WithParamInterface<const char*> {};

TEST_P(KilledAnywhere, LeavesTheOldOrTheNewResultWhole) {
  const std::string words = command(GetParam());
  const auto calls = countsOf(words);
  const auto result = contents(out());
  fs::remove_all(out().parent_path());
  int with_result = 0;
  for (long call = 1; call <= calls.changes; ++call) {
    const Outcome killed = run(words, "PLUMBLINE_KILL_AT=" + std::to_string(call));
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL) << call << killed.text;
    if (fs::exists(out())) {
      ++with_result;
      ASSERT_EQ(contents(out()), result) << call;
      ASSERT_TRUE(isWhole(out())) << call;
    }
    fs::remove_all(out());
    ASSERT_EQ(run(command("export")).exit_code, 0) << call;  // the next start, of any command
    EXPECT_EQ(entriesBeside(), 0U) << "left after call " << call;
    fs::remove_all(out().parent_path());
  }
  EXPECT_GT(with_result, 0) << "never killed after the rename";
}

TEST_P(KilledAnywhere, ReplacingLeavesTheOldOrTheNewResultWhole) {
  const std::string other =
      command(GetParam()) + (std::string(GetParam()) == "export" ? " --only cam0" : " --range 2");
  const std::string words = command(GetParam()) + " --force";
  ASSERT_EQ(run(other).exit_code, 0);
  const auto old = contents(out());
  fs::copy(out(), root_ / "old", fs::copy_options::recursive);
  const auto calls = countsOf(words);
  const auto result = contents(out());
  ASSERT_NE(old, result);
  int with_old = 0, with_new = 0;
  for (long call = 1; call <= calls.changes; ++call) {
    // Without what killed runs left: the next one would count the calls that remove it.
    fs::remove_all(out().parent_path());
    fs::create_directories(out().parent_path());
    fs::copy(root_ / "old", out(), fs::copy_options::recursive);
    const Outcome killed = run(words, "PLUMBLINE_KILL_AT=" + std::to_string(call));
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL) << call << killed.text;
    const auto left = contents(out());
    ASSERT_TRUE(left == old || left == result) << "a mixture after call " << call;
    ASSERT_TRUE(isWhole(out())) << call;
    ++(left == old ? with_old : with_new);
  }
  fs::remove_all(out());
  ASSERT_EQ(run(words).exit_code, 0);
  EXPECT_EQ(entriesBeside(), 0U) << "of processes that were killed";
  EXPECT_GT(with_old, 0);
  EXPECT_GT(with_new, 0);
}

// The older result is moved aside for a moment: then the next start puts it back.
TEST_F(FailingCalls, KilledWithoutExchangeTheNextStartPutsTheOldResultBack) {
  ASSERT_EQ(run(command("export") + " --only cam0").exit_code, 0);
  const auto old = contents(out());
  fs::copy(out(), root_ / "old", fs::copy_options::recursive);
  const std::string words = command("export") + " --force",
                    environment = "PLUMBLINE_NO_EXCHANGE=1 ";
  ASSERT_EQ(run(words, environment + "PLUMBLINE_COUNTS=" + (root_ / "counts").string()).exit_code,
            0);
  const auto result = contents(out());
  long changes = 0;
  std::istringstream(read(root_ / "counts")) >> changes;
  int missing = 0;
  for (long call = 1; call <= changes; ++call) {
    fs::remove_all(out());
    fs::copy(root_ / "old", out(), fs::copy_options::recursive);
    const Outcome killed = run(words, environment + "PLUMBLINE_KILL_AT=" + std::to_string(call));
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL) << call << killed.text;
    missing += fs::exists(out()) ? 0 : 1;
    ASSERT_EQ(run(command("export")).exit_code, 2) << "no earlier result after call " << call;
    const auto left = contents(out());
    ASSERT_TRUE(left == old || left == result) << "a mixture after call " << call;
    ASSERT_TRUE(isWhole(out())) << call;
    EXPECT_EQ(entriesBeside(), 0U) << call;
  }
  EXPECT_GT(missing, 0) << "never killed between the renames";
}

TEST_P(KilledAnywhere, AFullDiskIsSaidAndTheOldResultStays) {
  const std::string words = command(GetParam()) + " --force";
  ASSERT_EQ(run(words).exit_code, 0);
  const auto calls = countsOf(words);
  const auto old = contents(out());
  for (long write = 1; write <= calls.writes; ++write) {
    const Outcome full = run(words, "PLUMBLINE_FULL_AT=" + std::to_string(write));
    ASSERT_EQ(full.exit_code, 2) << write << full.text;
    EXPECT_THAT(full.text, testing::AnyOf(HasSubstr("No space left"), HasSubstr("full"))) << write;
    EXPECT_EQ(contents(out()), old) << write;
    EXPECT_EQ(entriesBeside(), 0U) << write;
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, KilledAnywhere, testing::Values("export", "compare"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(FailingCalls, AFullStandardOutputIsNoSuccess) {
  const std::string words = "export " + (kOutputConfigs / "source/calibration.json").string() +
                            " --to basalt --out " + out().string();
  const Outcome full = shell(std::string(PLUMBLINE_BINARY) + " " + words + " > /dev/full");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.text, HasSubstr("standard output cannot be written (No space left on device)"));
  EXPECT_TRUE(isWhole(out()));
  EXPECT_NE(shell(std::string(PLUMBLINE_BINARY) + " --help > /dev/full").exit_code, 0);
  // Closed ones are not taken by files of the result.
  for (const char* closed : {" >&-", " 2>&-", " <&- >&- 2>&-"}) {
    const Outcome outcome =
        shell(std::string(PLUMBLINE_BINARY) + " " + words + " --force" + closed);
    EXPECT_EQ(outcome.exit_code, std::string(closed) == " 2>&-" ? 0 : 1) << closed;
    EXPECT_TRUE(isWhole(out())) << closed;
  }
}

TEST_F(FailingCalls, APipeThatNobodyReadsIsNoSuccessAndEndsNoRun) {
  const std::string words = std::string(PLUMBLINE_BINARY) + " export " +
                            (kOutputConfigs / "source/calibration.json").string() +
                            " --to basalt --force --out " + out().string();
  for (const char* errors : {"", " 2>&1"}) {
    // The program starts once the pipe's reader is gone.
    const Outcome outcome = shell("{ while (echo x) 2>/dev/null; do :; done; " + words + errors +
                                  "; echo code $? >&2; } | :");
    EXPECT_THAT(outcome.text, HasSubstr("code 1\n")) << errors;
    EXPECT_EQ(
        outcome.text.find("standard output cannot be written (Broken pipe)") != std::string::npos,
        std::string(errors).empty())
        << outcome.text;
    EXPECT_TRUE(isWhole(out())) << errors;
    fs::remove_all(out());
  }
}

TEST_F(FailingCalls, ATooLargeFileIsSaid) {
  const Outcome outcome = shell("ulimit -f 1; " + std::string(PLUMBLINE_BINARY) +
                                " simulate --duration 2 --out " + out().string());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("File too large"));
  EXPECT_FALSE(fs::exists(out().parent_path()));
}

TEST_F(FailingCalls, SiblingsOfOneNewParentDoNotHurtEachOther) {
  const std::string source = (kOutputConfigs / "source/calibration.json").string();
  const std::string start = std::string(PLUMBLINE_BINARY) + " export ";
  for (int round = 0; round < 8; ++round) {
    std::string command;
    for (int i = 0; i < 6; ++i) {  // every second one fails, in an order of chance
      const std::string input = i % 2 == 0 ? source : (root_ / "missing.json").string();
      command += start + input + " --to kalibr --out " +
                 (root_ / "parent/deep" / std::to_string(i)).string() + " & ";
    }
    shell(command + "wait");
    for (int i = 0; i < 6; ++i) {
      const fs::path result = root_ / "parent/deep" / std::to_string(i);
      EXPECT_EQ(fs::exists(result), i % 2 == 0) << round << " " << i;
      if (i % 2 == 0) {
        EXPECT_TRUE(isWhole(result));
      }
    }
    fs::remove_all(root_ / "parent");
  }
}

TEST_F(FailingCalls, SingleFilesNeedNoHardLinks) {
  const fs::path file = root_ / "one.json";
  const std::string words = command("compare") + " --force --json " + file.string();
  const auto withError = [&](int error) {
    fs::remove(file);
    return run(words, "PLUMBLINE_LINK_ERROR=" + std::to_string(error));
  };
  for (const int error : {EPERM, EOPNOTSUPP, ENOSYS, EXDEV, EMLINK}) {
    const Outcome outcome = withError(error);
    EXPECT_EQ(outcome.exit_code, 0) << error << outcome.text;
    EXPECT_TRUE(fs::exists(file)) << error;
  }
  EXPECT_EQ(withError(EIO).exit_code, 2);
}

TEST_F(FailingCalls, EqualProcessIdsOfContainersDoNotMeet) {
  const auto simulation = [&](int seed) {
    return std::string("ASAN_OPTIONS=verify_asan_link_order=0 PLUMBLINE_PID=7 LD_PRELOAD=") +
           PLUMBLINE_FAILING_CALLS + " " + PLUMBLINE_BINARY + " simulate --duration 4 --out " +
           out().string() + " --seed " + std::to_string(seed);
  };
  const Outcome outcome = shell(simulation(1) + " & " + simulation(2) + " & wait");
  EXPECT_TRUE(isWhole(out())) << outcome.text;
  EXPECT_EQ(entriesBeside(), 0U);
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("The truth is in"), HasSubstr("contains an earlier")));
}

TEST_F(FailingCalls, TheLockNamesTheProcess) {  // so that the test above has two of one id
  fs::create_directories(root_ / "parent");
  const long calls = countsOf(command("export")).changes;
  fs::remove_all(out());
  run(command("export"), "PLUMBLINE_PID=7 PLUMBLINE_KILL_AT=" + std::to_string(calls / 2));
  std::string locks;
  for (const auto& entry : fs::recursive_directory_iterator(root_)) {
    if (entry.path().filename() == "lock") locks += read(entry.path());
  }
  EXPECT_THAT(locks, HasSubstr("pid 7\n"));
}

// Starts simulate, which renders for long, waits for its workplace and sends a signal.
int exitCodeAfter(int signal, const fs::path& out, const fs::path& errors) {
  const pid_t child = fork();
  if (child == 0) {
    std::freopen(errors.c_str(), "w", stderr);
    execl(PLUMBLINE_BINARY, "plumbline", "simulate", "--images", "--duration", "60", "--out",
          out.c_str(), nullptr);
    _exit(99);
  }
  const auto started = [&] {
    if (!fs::exists(out.parent_path())) return false;
    for (const auto& entry : fs::recursive_directory_iterator(
             out.parent_path(), fs::directory_options::skip_permission_denied)) {
      if (entry.path().extension() == ".png") return true;
    }
    return false;
  };
  for (int i = 0; i < 3000 && !started(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(child, signal);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST_F(FailingCalls, SignalsCleanUp) {
  for (const auto& [signal, code] : std::map<int, int>{{SIGINT, 130}, {SIGTERM, 143}}) {
    EXPECT_EQ(exitCodeAfter(signal, out(), root_ / "errors"), code);
    EXPECT_FALSE(fs::exists(out().parent_path()));
    EXPECT_THAT(read(root_ / "errors"), HasSubstr("stopped by signal"));
  }
}

// Also between any two of its steps, while the work goes on in another thread.
TEST_F(FailingCalls, ASignalAtAnyMomentLeavesNothingOrAWholeResult) {
  const std::string source = (kOutputConfigs / "source/calibration.json").string();
  int stopped = 0;
  for (int i = 0; i < 80; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      std::freopen("/dev/null", "w", stdout);
      std::freopen("/dev/null", "w", stderr);
      execl(PLUMBLINE_BINARY, "plumbline", "export", source.c_str(), "--to", "openvins", "--out",
            out().c_str(), nullptr);
      _exit(99);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(300 * i));
    kill(child, SIGTERM);
    int status = 0;
    waitpid(child, &status, 0);
    stopped += WIFEXITED(status) && WEXITSTATUS(status) == 143 ? 1 : 0;
    EXPECT_EQ(entriesBeside(), 0U) << i << ", status " << status << namesBeside();
    if (fs::exists(out())) {
      EXPECT_TRUE(isWhole(out())) << i;
    }
    fs::remove_all(out().parent_path());
  }
  RecordProperty("stopped", stopped);  // how many it is depends on the machine
}

TEST_F(FailingCalls, ADeadOnesWorkplaceGoesAtTheNextStart) {
  EXPECT_EQ(exitCodeAfter(SIGKILL, out(), root_ / "errors"), -SIGKILL);
  EXPECT_EQ(entriesBeside(), 1U);
  ASSERT_EQ(shell(std::string(PLUMBLINE_BINARY) + " simulate --duration 2 --out " + out().string())
                .exit_code,
            0);
  EXPECT_EQ(entriesBeside(), 0U);
}

}  // namespace
}  // namespace plumbline
