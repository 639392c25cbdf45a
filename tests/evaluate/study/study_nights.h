// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/wait.h>

#include "report/store/study_store.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {

using testing::HasSubstr;
using testing::Not;

/// Nights of a small study of four sessions, made once for the tests of a file with a night that
/// nothing disturbed. The lens model is stated: to choose one takes ten times as long as the rest
/// of a calibration; and the recordings are as slow as lets all steps succeed.
class StudyNights : public testing::Test {
 protected:
  static void SetUpTestSuite() { makeNights(kFourSessions, Cameras::kOne); }
  enum class Cameras { kOne, kTwo };
  /// The recordings, the study of these sessions, and its night. One camera is a quarter faster,
  /// for tests of what a night does rather than of what it finds.
  static void makeNights(const std::string& sessions, Cameras cameras) {
    root_ = fs::temp_directory_path() / ("plumbline_nights_" + std::to_string(getpid()));
    fs::remove_all(root_);
    int seed = 0;
    for (const char* name : {"p1_free", "p1_guided", "p2_free", "p2_guided", "eval"}) {
      const Outcome outcome = plumbline("simulate --out " + (root_ / "data" / name).string() +
                                        " --duration 6 --camera-rate 5 --imu-rate 100 --seed " +
                                        std::to_string(++seed));
      ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
      if (cameras == Cameras::kOne) fs::remove_all(root_ / "data" / name / "mav0/cam1");
    }
    write(root_ / "data/STUDY.yaml",
          "study: small\nmethods: [free, guided]\nsessions:\n" + sessions +
              "held_out: [{name: eval, path: eval}]\nperturbations: {offsets_ms: [10]}\n" +
              kCalibrate);
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome = study(root_ / "data", root_ / "undisturbed");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    undisturbed_ = std::chrono::steady_clock::now() - begin;
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

  enum class FirstNights { kCompare, kIgnore };

  /// Everything that the store says but seconds and dates.
  static std::map<std::string, std::string> values(
      const fs::path& night, FirstNights first_nights = FirstNights::kCompare) {
    const StudyStore store(night / "study.sqlite");
    std::map<std::string, std::string> all;
    for (const FigureSpan& span : store.figures()) {
      const StudyFigure& f = span.figure;
      if (f.name == "calibration_s") continue;
      all[f.session + " " + f.name] =
          f.inputs_key + " " + f.version + " " +
          (first_nights == FirstNights::kCompare ? std::to_string(span.first_night) : "") + " " +
          std::string(reinterpret_cast<const char*>(&f.value), sizeof f.value);
    }
    for (const StudyStepRow& s : store.steps()) all[s.name] = s.key + s.status + s.message;
    return all;
  }

  /// When each step that is settled was done. A process that is dying may remove folders that this
  /// walks through.
  static std::map<std::string, std::int64_t> times(const fs::path& night) {
    for (int attempt = 1;; ++attempt) {
      try {
        return timesNow(night);
      } catch (const fs::filesystem_error&) {
        if (attempt == 100) throw;
      }
    }
  }
  static std::map<std::string, std::int64_t> timesNow(const fs::path& night) {
    std::map<std::string, std::int64_t> all;
    if (!fs::exists(night)) return all;
    for (fs::recursive_directory_iterator entry(night), end; entry != end; ++entry) {
      if (entry->path().string().find(".partial-") != std::string::npos) {
        entry.disable_recursion_pending();
        continue;
      }
      if (entry->path().filename() != "step.json") continue;
      struct stat status {};
      stat(entry->path().c_str(), &status);
      all[fs::relative(entry->path().parent_path(), night).string()] =
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

  static constexpr const char* kFourSessions =
      "  - {name: p1_free, participant: p1, method: free, period: 1, path: p1_free}\n"
      "  - {name: p1_guided, participant: p1, method: guided, period: 2, path: p1_guided}\n"
      "  - {name: p2_free, participant: p2, method: free, period: 2, path: p2_free}\n"
      "  - {name: p2_guided, participant: p2, method: guided, period: 1, path: p2_guided}\n";
  static constexpr const char* kCalibrate = "calibrate: {models: pinhole-radtan}\n";
  static inline fs::path root_;
  static inline std::chrono::duration<double, std::milli> undisturbed_{};  ///< time of that night
  fs::path scratch_;
};

/// Nights of the same study, of two cameras, with more in its definition.
class StudyStepNights : public StudyNights {
 protected:
  using Json = nlohmann::json;

  static void SetUpTestSuite() { makeNights(kFourSessions, Cameras::kTwo); }

  // The study with more in its definition, done after the night that nothing disturbed, so that no
  // more than that more is; its summary.
  Json night(const fs::path& data, const std::string& further) const {
    write(data / "STUDY.yaml", read(root_ / "data/STUDY.yaml") + further);
    if (!fs::exists(scratch_ / "night")) doneNight();
    const Outcome outcome = study(data, scratch_ / "night");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return Json::parse(read(scratch_ / "night/summary.json"));
  }
  std::string commandOf(const std::string& step) const {
    return Json::parse(read(scratch_ / "night" / step / "step.json")).at("command");
  }
  Outcome simulate(const fs::path& folder, const std::string& options) const {
    fs::remove_all(folder);
    return plumbline("simulate --out " + folder.string() + " " + options);
  }

  static constexpr const char* kSequence =
      "sequences: [{name: s, path: eval, truth: eval/truth/trajectory.csv}]\n";
};

}  // namespace plumbline
