// SPDX-License-Identifier: BSD-3-Clause
// Nights of a small study: what changes is done again and nothing else, whatever is killed.
#include <csignal>
#include <map>
#include <random>
#include <set>
#include <thread>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/wait.h>

#include "report/store/study_store.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

class StudyNights : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("plumbline_nights_" + std::to_string(getpid()));
    fs::remove_all(root_);
    int seed = 0;
    for (const char* name : {"p1_free", "p1_guided", "p2_free", "p2_guided", "eval"}) {
      const Outcome outcome = plumbline("simulate --out " + (root_ / "data" / name).string() +
                                        " --duration 6 --seed " + std::to_string(++seed));
      ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    }
    write(root_ / "data/STUDY.yaml",
          "study: small\nmethods: [free, guided]\nsessions:\n"
          "  - {name: p1_free, participant: p1, method: free, period: 1, path: p1_free}\n"
          "  - {name: p1_guided, participant: p1, method: guided, period: 2, path: p1_guided}\n"
          "  - {name: p2_free, participant: p2, method: free, period: 2, path: p2_free}\n"
          "  - {name: p2_guided, participant: p2, method: guided, period: 1, path: p2_guided}\n"
          "held_out: [{name: eval, path: eval}]\nperturbations: {offsets_ms: [10]}\n");
    const Outcome outcome = study(root_ / "data", root_ / "undisturbed");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  static void TearDownTestSuite() {
    if (HasFailure()) return;
    fs::remove_all(root_);
  }

  void SetUp() override {
    scratch_ = root_ / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(scratch_);
  }
  // A copy of the recordings that may be spoiled, and of the night that is done with them.
  fs::path ownData() const {
    fs::copy(root_ / "data", scratch_ / "data", fs::copy_options::recursive);
    return scratch_ / "data";
  }
  fs::path doneNight() const {
    fs::copy(root_ / "undisturbed", scratch_ / "night", fs::copy_options::recursive);
    return scratch_ / "night";
  }

  static std::string words(const fs::path& data, const fs::path& night) {
    return "study " + (data / "STUDY.yaml").string() + " --out " + night.string();
  }
  static Outcome study(const fs::path& data, const fs::path& night,
                       const std::string& options = "") {
    return plumbline(words(data, night) + " " + options);
  }

  /// Everything that the store says but seconds and dates.
  static std::map<std::string, std::string> values(const fs::path& night) {
    const StudyStore store(night / "study.sqlite");
    std::map<std::string, std::string> all;
    for (const FigureSpan& span : store.figures()) {
      const StudyFigure& f = span.figure;
      if (f.name == "calibration_s") continue;
      all[f.session + " " + f.name] =
          f.inputs_key + " " + f.version + " " + std::to_string(span.first_night) + " " +
          std::string(reinterpret_cast<const char*>(&f.value), sizeof f.value);
    }
    for (const StudyStepRow& s : store.steps()) all[s.name] = s.key + s.status + s.message;
    return all;
  }

  /// When each step that is settled was done.
  static std::map<std::string, std::int64_t> times(const fs::path& night) {
    std::map<std::string, std::int64_t> all;
    if (!fs::exists(night)) return all;
    for (const auto& entry : fs::recursive_directory_iterator(night)) {
      if (entry.path().filename() != "step.json") continue;
      if (entry.path().string().find(".partial-") != std::string::npos) continue;
      struct stat status {};
      stat(entry.path().c_str(), &status);
      all[fs::relative(entry.path().parent_path(), night).string()] =
          status.st_mtim.tv_sec * 1'000'000'000LL + status.st_mtim.tv_nsec;
    }
    return all;
  }

  static std::set<std::string> doneAgain(const std::map<std::string, std::int64_t>& before,
                                         const fs::path& night) {
    std::set<std::string> names;
    for (const auto& [name, time] : times(night)) {
      if (before.count(name) == 0 || before.at(name) != time) names.insert(name);
    }
    return names;
  }

  static Outcome shell(const std::string& command) {
    Outcome outcome;
    std::FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) outcome.text += buffer;
    const int status = pclose(pipe);
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    return outcome;
  }

  static pid_t start(const std::string& command) {
    const pid_t pid = fork();
    if (pid == 0) {
      execl("/bin/sh", "sh", "-c",
            ("exec " + std::string(PLUMBLINE_BINARY) + " " + command + " >/dev/null 2>&1").c_str(),
            nullptr);
      _exit(127);
    }
    return pid;
  }

  static inline fs::path root_;
  fs::path scratch_;
};

TEST_F(StudyNights, AnUnchangedNightDoesNothingAgain) {
  const fs::path night = doneNight();
  const auto before = times(night);
  EXPECT_EQ(before.size(), 12u);
  const Outcome outcome = study(root_ / "data", night);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("Night 2: 4 of 4 sessions"));
  EXPECT_TRUE(doneAgain(before, night).empty());
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
  const auto summary = nlohmann::json::parse(read(night / "summary.json"));
  EXPECT_EQ(summary.at("nights").size(), 2u);
  EXPECT_EQ(summary.at("sessions").size(), 4u);
  EXPECT_GT(summary.at("sessions")[0].at("held_out_rmse_px").get<double>(), 0.1);
  EXPECT_TRUE(fs::exists(night / summary.at("sessions")[0].at("page").get<std::string>()));
  EXPECT_THAT(read(night / "index.html"), HasSubstr("p2_guided"));
}

TEST_F(StudyNights, ResultsDoNotDependOnJobs) {
  const Outcome outcome = study(root_ / "data", scratch_ / "night", "--jobs 1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(values(scratch_ / "night"), values(root_ / "undisturbed"));
}

TEST_F(StudyNights, AChangedSessionAloneIsDoneAgain) {
  const fs::path data = ownData(), night = doneNight();
  const auto before = times(night);
  fs::remove_all(data / "p1_free");
  fs::copy(data / "eval", data / "p1_free", fs::copy_options::recursive);
  EXPECT_EQ(study(data, night).exit_code, 0);
  EXPECT_EQ(doneAgain(before, night),
            (std::set<std::string>{"sessions/p1_free/calibrate", "sessions/p1_free/evaluate_eval",
                                   "sessions/p1_free/perturb"}));
}

TEST_F(StudyNights, ACorruptSessionCostsItselfAlone) {
  const fs::path data = ownData();
  write(data / "p1_free/mav0/cam0/corners.csv", "no corners\n1,2\n");
  const Outcome outcome = study(data, scratch_ / "night");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("3 of 4 sessions have a calibration"));
  const auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  const auto& session = summary.at("sessions")[0];
  EXPECT_EQ(session.at("status"), "failed");
  EXPECT_EQ(session.at("failed_step"), "calibrate");
  EXPECT_THAT(session.at("message").get<std::string>(), HasSubstr("corners.csv"));
  EXPECT_EQ(summary.at("held_out").size(), 3u);
  const auto before = times(scratch_ / "night");
  EXPECT_EQ(study(data, scratch_ / "night").exit_code, 0);
  EXPECT_TRUE(doneAgain(before, scratch_ / "night").empty()) << "it would fail again";
  EXPECT_EQ(study(data, scratch_ / "night", "--redo-failed").exit_code, 0);
  EXPECT_EQ(doneAgain(before, scratch_ / "night").size(), 1u);
}

TEST_F(StudyNights, AStepBeyondItsTimeEndsWithAllThatItStarted) {
  const fs::path data = ownData();
  write(data / "STUDY.yaml",
        read(data / "STUDY.yaml") +
            "sequences: [{name: s, path: eval, truth: "
            "eval/truth/trajectory.csv}]\n"
            "trajectories: {command: 'sleep 54321 & sleep 54321; echo {out}'}\n"
            "limits: {step_s: 12}\n");
  const Outcome outcome = study(data, scratch_ / "night", "--jobs 8");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  const auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  ASSERT_EQ(summary.at("trajectories").size(), 4u);
  EXPECT_THAT(summary.at("trajectories")[0].at("failure").get<std::string>(),
              HasSubstr("not done after 12 s"));
  EXPECT_NE(std::system("pgrep -f 'sleep 5432[1]' >/dev/null"), 0) << "left running";
}

TEST_F(StudyNights, AStepBeyondItsMemoryFailsAlone) {
  const fs::path data = ownData();
  write(data / "STUDY.yaml", read(data / "STUDY.yaml") +
                                 "sequences: [{name: s, path: eval, truth: "
                                 "eval/truth/trajectory.csv}]\n"
                                 "trajectories: {command: 'head -c 1G /dev/zero | tail'}\n"
                                 "limits: {step_mb: 600}\n");
  const Outcome outcome = study(data, scratch_ / "night");
  EXPECT_THAT(outcome.text, HasSubstr("4 of 4 sessions have a calibration"));
  const auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  EXPECT_THAT(summary.at("trajectories")[0].at("failure").get<std::string>(),
              HasSubstr("memory exhausted"));
}

TEST_F(StudyNights, TrajectoriesComeFromACommandOrAPattern) {
  const fs::path data = ownData();
  const std::string study_file = read(data / "STUDY.yaml") +
                                 "sequences: [{name: s, path: eval, truth: "
                                 "eval/truth/trajectory.csv}]\n";
  write(data / "STUDY.yaml", study_file +
                                 "trajectories: {command: 'test -f {calibration} && cp "
                                 "{sequence}/truth/trajectory.csv {out}'}\n");
  EXPECT_EQ(study(data, scratch_ / "night").exit_code, 0);
  auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  ASSERT_EQ(summary.at("trajectories").size(), 4u);
  EXPECT_LT(summary.at("trajectories")[0].at("ate_m").get<double>(), 1e-9);
  fs::create_directories(data / "runs/p1_free");
  fs::copy(data / "eval/truth/trajectory.csv", data / "runs/p1_free/s_1.txt");
  write(data / "runs/p1_free/s_2.txt", "no trajectory\n");
  write(data / "STUDY.yaml",
        study_file + "trajectories: {pattern: 'runs/{calibration}/{sequence}_{run}.txt'}\n");
  EXPECT_EQ(study(data, scratch_ / "night").exit_code, 0);
  summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  ASSERT_EQ(summary.at("trajectories").size(), 2u);
  EXPECT_EQ(summary.at("trajectories")[0].at("run"), "1");
  EXPECT_LT(summary.at("trajectories")[0].at("ate_m").get<double>(), 1e-9);
  EXPECT_THAT(summary.at("trajectories")[1].at("failure").get<std::string>(), HasSubstr("s_2.txt"));
}

// SIGKILL of the study, and of whatever process of a step is there, at random moments: the next
// start takes up what is done, does none of it twice, and ends at the same values.
TEST_F(StudyNights, ResumeAfterSigkillAtRandomMoments) {
  std::mt19937 random(20261122);
  std::uniform_int_distribution<int> pause_ms(10, 400);
  int kills = 0, nights = 0;
  while (kills < 24) {
    const fs::path night = scratch_ / ("night" + std::to_string(++nights));
    for (bool ended = false; !ended;) {
      const auto before = times(night);
      const pid_t pid = start(words(root_ / "data", night));
      std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms(random)));
      int status = 0;
      ended = waitpid(pid, &status, WNOHANG) == pid;
      if (!ended) {
        const bool a_step = kills % 3 == 2;
        if (a_step) {  // the latest process of a step; the study goes on
          const std::string find = "pgrep -n -f '" + night.string() +
                                   ".*partial-' >/dev/null && "
                                   "kill -9 $(pgrep -n -f '" +
                                   night.string() + ".*partial-')";
          (void)std::system(find.c_str());
          waitpid(pid, &status, 0);
          ended = true;
        } else {
          kill(pid, SIGKILL);
          waitpid(pid, &status, 0);
        }
        ++kills;
      }
      if (ended) EXPECT_EQ(WEXITSTATUS(status), 0);
      const auto after = times(night);
      for (const auto& [name, time] : before) EXPECT_EQ(after.at(name), time) << name << " again";
    }
    EXPECT_EQ(values(night), values(root_ / "undisturbed"));
    EXPECT_EQ(plumbline(words(root_ / "data", night)).exit_code, 0);  // removes what was left
    for (const auto& entry : fs::recursive_directory_iterator(night)) {
      EXPECT_THAT(entry.path().string(), Not(HasSubstr(".partial"))) << "left behind";
    }
  }
}

TEST_F(StudyNights, ASecondNightSaysSoAndLeaves) {
  const fs::path night = scratch_ / "night";
  const pid_t first = start(words(root_ / "data", night));
  while (!fs::exists(night / "plan.jsonl")) std::this_thread::yield();
  const Outcome second = study(root_ / "data", night);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.text,
              HasSubstr("another night is at work here: process " + std::to_string(first)));
  int status = 0;
  waitpid(first, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
}

TEST_F(StudyNights, ASessionChangedMeanwhileIsReadAgainTheNextNight) {
  const fs::path data = ownData(), night = scratch_ / "night";
  const pid_t pid = start(words(data, night) + " --jobs 1");
  while (!fs::exists(night / "plan.jsonl")) std::this_thread::yield();
  // The plan is of the older state: whatever step reads this next must say so.
  for (const char* name : {"p1_free", "p1_guided", "p2_free", "p2_guided"}) {
    write(data / name / "mav0/note.txt", "changed");
  }
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_THAT(read(night / "summary.json"), HasSubstr("changed"));
  const Outcome next = study(data, night);
  EXPECT_THAT(next.text, HasSubstr("4 of 4 sessions have a calibration"));
}

TEST_F(StudyNights, AnotherValueFromTheSameInputsIsARegressionUntilAccepted) {
  const fs::path night = doneNight();
  const fs::path step = night / "sessions/p1_free/evaluate_eval/step.json";
  auto json = nlohmann::ordered_json::parse(read(step));
  auto& rmse = json.at("part").at("held_out")[0].at("rmse_px");
  rmse = rmse.get<double>() * 1.001;
  write(step, json.dump());
  const Outcome bad = study(root_ / "data", night);
  EXPECT_EQ(bad.exit_code, 3) << bad.text;
  EXPECT_THAT(bad.text, HasSubstr("held_out_rmse_px/eval of p1_free"));
  EXPECT_THAT(bad.text, HasSubstr("since night 2"));
  EXPECT_THAT(bad.text, HasSubstr("plumbline evaluate calibration"));
  EXPECT_EQ(study(root_ / "data", night).exit_code, 3) << "until somebody looks at it";
  EXPECT_EQ(plumbline("study accept " + night.string() + " --session p2_free").exit_code, 2);
  const Outcome accepted =
      plumbline("study accept " + night.string() + " --figure held_out_rmse_px --note 'a test'");
  EXPECT_EQ(accepted.exit_code, 0) << accepted.text;
  EXPECT_EQ(study(root_ / "data", night).exit_code, 0);
  // Done again it is what it was at first: the same inputs, another value than was accepted.
  const auto before = times(night);
  EXPECT_EQ(study(root_ / "data", night, "--recheck 12").exit_code, 3);
  EXPECT_EQ(doneAgain(before, night).size(), 12u);
}

TEST_F(StudyNights, ANewerOrForeignStoreIsLeftAlone) {
  const fs::path night = doneNight();
  {
    SQLite::Database db((night / "study.sqlite").string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA user_version = 99");
  }
  const std::string newer = read(night / "study.sqlite");
  const Outcome outcome = study(root_ / "data", night);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("has version 99, this program knows 1"));
  EXPECT_EQ(read(night / "study.sqlite"), newer);
  write(night / "study.sqlite", "not a database, but long enough to look like some other file");
  EXPECT_THAT(study(root_ / "data", night).text, HasSubstr("damaged"));
}

TEST_F(StudyNights, FoldersOfOthersAreLeftAlone) {
  write(scratch_ / "letters.txt", "mine");
  const Outcome foreign = study(root_ / "data", scratch_);
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.text, HasSubstr("letters.txt"));
  const Outcome inside = study(root_ / "data", root_ / "data/eval/night");
  EXPECT_EQ(inside.exit_code, 2);
  EXPECT_FALSE(fs::exists(root_ / "data/eval/night"));
  fs::create_directories(scratch_ / "other");
  write(scratch_ / "other/STUDY.yaml", replaced(read(root_ / "data/STUDY.yaml"), "small", "other"));
  for (const auto& entry : fs::directory_iterator(root_ / "data")) {
    if (entry.is_directory()) {
      fs::create_directory_symlink(entry.path(), scratch_ / "other" / entry.path().filename());
    }
  }
  const Outcome other = study(scratch_ / "other", root_ / "undisturbed");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.text, HasSubstr("belongs to the study 'small'"));
}

TEST_F(StudyNights, AnOutputThatCannotBeWrittenIsNamed) {
  EXPECT_EQ(study(root_ / "data", "/proc/night").exit_code, 2);
  write(scratch_ / "file", "");
  const Outcome outcome = study(root_ / "data", scratch_ / "file");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("is no folder"));
}

// From the n-th write of every process on there is no space.
TEST_F(StudyNights, AFullDiskEndsTheNightAndLosesNothing) {
  for (const int n : {1, 4, 12}) {
    const fs::path night = scratch_ / std::to_string(n);
    const Outcome full = shell(
        "ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD=" + std::string(PLUMBLINE_FAILING_CALLS) +
        " PLUMBLINE_FULL_AT=" + std::to_string(n) + " " + PLUMBLINE_BINARY + " " +
        words(root_ / "data", night));
    EXPECT_EQ(full.exit_code, 2) << full.text;
    EXPECT_THAT(full.text,
                testing::AnyOf(HasSubstr("No space left on device"), HasSubstr("disk is full")));
    const Outcome again = study(root_ / "data", night);
    EXPECT_EQ(again.exit_code, 0) << again.text;
    EXPECT_EQ(values(night), values(root_ / "undisturbed")) << n;
  }
}

// The program may be replaced while a night runs: it goes on as it began.
TEST_F(StudyNights, AnotherBuildUnderTheSameNameMeanwhileChangesNothing) {
  const fs::path program = scratch_ / "plumbline";
  fs::copy_file(PLUMBLINE_BINARY, program);
  const fs::path night = scratch_ / "night";
  const pid_t pid = fork();
  if (pid == 0) {
    execl("/bin/sh", "sh", "-c",
          ("exec " + program.string() + " " + words(root_ / "data", night) + " >/dev/null 2>&1")
              .c_str(),
          nullptr);
    _exit(127);
  }
  while (!fs::exists(night / "plan.jsonl")) std::this_thread::yield();
  fs::remove(program);
  write(program, "#!/bin/sh\nexit 1\n");
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
}

TEST_F(StudyNights, TheListOfCommandsGivesTheSameStore) {
  const fs::path night = scratch_ / "night";
  const Outcome list = study(root_ / "data", night, "--engine commands");
  ASSERT_EQ(list.exit_code, 0) << list.text;
  EXPECT_EQ(std::count(list.text.begin(), list.text.end(), '\n'), 12 + 2 + 2);
  write(scratch_ / "commands.sh", list.text);
  EXPECT_EQ(WEXITSTATUS(std::system(
                ("sh " + (scratch_ / "commands.sh").string() + " >/dev/null 2>&1").c_str())),
            0);
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
}

TEST_F(StudyNights, OptionsOfCalibrateAreCheckedBeforeAnythingRuns) {
  const fs::path data = ownData();
  const std::string good = read(data / "STUDY.yaml");
  for (const char* options : {"{loss: cauchy}", "{pixel-sigma: -1}", "{colour: red}", "{out: here}",
                              "{models: fisheye}"}) {
    write(data / "STUDY.yaml", good + "calibrate: " + options + "\n");
    const Outcome outcome = study(data, scratch_ / "night");
    EXPECT_EQ(outcome.exit_code, 2) << options;
    EXPECT_THAT(outcome.text, HasSubstr("STUDY.yaml:10: ")) << options;
    EXPECT_FALSE(fs::exists(scratch_ / "night"));
  }
}

}  // namespace
}  // namespace plumbline
