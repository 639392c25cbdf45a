// SPDX-License-Identifier: BSD-3-Clause
// What holds in every command that writes: --force, --json, --fail-on, provenance, NO_COLOR. The
// list of commands is the program's own: one that is not in the table here is a failure.
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/datasets/bag/bag_of_session.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Every command that does something: "evaluate trajectory"; those that have others below them too.
std::set<std::string> allCommands() {
  std::set<std::string> all;
  for (const std::string& name : listedCommands(plumbline("--help").text)) {
    const auto parts = listedCommands(plumbline(name + " --help").text);
    for (const std::string& part : parts) all.insert(name + " " + part);
    if (name != "evaluate" && name != "target") all.insert(name);
  }
  return all;
}

enum class Writes {
  kFiles,     ///< neither a document nor a verdict
  kDocument,  ///< --json
  kFigures,   ///< --json of the figures alone, and --fail-on
  kVerdict    ///< --json and --fail-on
};

struct Case {
  std::string words;      ///< the command
  std::string arguments;  ///< without --out
  Writes writes = Writes::kFiles;
  std::string out = "out";  ///< name of what is written
};

class EveryCommand : public CommandLine {
 protected:
  /// Choosing lens models is most of a calibration, and the same for every option tested here.
  static constexpr const char* kAsStated = " --models pinhole-radtan";

  static void SetUpTestSuite() {
    makeSession("--duration 12 --camera-rate 10");
    const auto make = [](const std::string& words) {
      const Outcome outcome = plumbline(words);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    };
    make("simulate --rig d435i --seed 2 --duration 1 --camera-rate 5 --images --out " +
         at("images"));
    writeBagOf(at("images"), at("bag.db3"));
    make("simulate sequence --seed 2 --duration 4 --tracks 60 --out " + at("flight"));
    make("calibrate " + at("session") + kAsStated + " --no-cache --no-report --out " +
         at("result"));
    // The commands read a study of `simulate study` in study_trajectories_cli_test.cpp.
    std::string sessions;
    for (const char* name : {"p1_free", "p1_guided", "p2_free", "p2_guided"}) {
      const std::string participant = std::string(name).substr(0, 2);
      const std::string method = std::string(name).substr(3);
      const bool first = (participant == "p1") == (method == "free");
      sessions += "  - {name: " + std::string(name) + ", participant: " + participant +
                  ", method: " + method + ", period: " + (first ? "1" : "2") + ", path: " + name +
                  "}\n";
    }
    int seed = 0;
    for (const char* name : {"p1_free", "p1_guided", "p2_free", "p2_guided", "eval"}) {
      make("simulate --duration 6 --camera-rate 5 --imu-rate 100 --seed " + std::to_string(++seed) +
           " --out " + at("study/" + std::string(name)));
      fs::remove_all(root_ / "study" / name / "mav0/cam1");
    }
    write(at("study/STUDY.yaml"), "study: small\nmethods: [free, guided]\nsessions:\n" + sessions +
                                      "held_out: [{name: eval, path: eval}]\n"
                                      "calibrate: {models: pinhole-radtan}\n");
  }
  static std::string at(const std::string& name) { return (root_ / name).string(); }

  static std::vector<Case> cases() {
    const std::string s = at("session") + " --no-cache", short_s = s + " --to 6";
    const std::string ours = at("result/calibration.json");
    const std::string truth = at("session/truth/camchain-imucam.yaml");
    const std::string flown = at("flight/truth/trajectory.csv");
    const auto verdict = Writes::kVerdict;
    const auto document = Writes::kDocument;
    return {
        {"simulate", "--seed 1 --duration 1"},
        {"simulate operator", "--seed 1 --method free --duration 8"},
        {"simulate sequence", "--seed 1 --duration 1"},
        {"simulate study", "--participants 1 --duration 6 --sequences 0 --held-out 1"},
        {"import", at("bag.db3"), document},
        {"detect", at("images") + " --no-cache", document},
        {"calibrate", short_s + kAsStated + " --no-imu", verdict},
        {"evaluate calibration", truth + " " + short_s + " --no-imu", verdict},
        {"evaluate trajectory", flown + " " + flown, Writes::kFigures},
        {"evaluate trajectories", "'" + at("flight/{run}/{sequence}.csv") + "' --truth " + flown,
         verdict},
        {"compare", ours + " " + truth + " --labels ours,truth --grid 5x3 --focus-radius 300",
         verdict},
        {"odometry",
         at("flight") + " --calibration " + at("flight/truth/camchain-imucam.yaml") + " --truth " +
             flown,
         verdict},
        {"export", ours + " --to openvins", document},
        {"target fit", at("session") + kAsStated, Writes::kFiles, "shape.yaml"},
        {"target print", "--rows 2 --cols 2 --tag-size 40mm", Writes::kFiles, "sheet.pdf"},
        {"perturb", short_s + " --offsets-ms 10", verdict},
        {"replay", at("session") + " --no-cache --to 4 --no-counterfactuals", verdict},
        {"report", at("result"), document, "page.html"},
    };
  }
  Outcome run(const Case& c, const std::string& more) const {
    return plumbline(c.words + " " + c.arguments + " --out " + (scratch() / c.out).string() + more);
  }
  /// That the help of a command offers what it writes.
  static void expectOptionsInHelp(const Case& c) {
    const std::string help = plumbline(c.words + " --help").text;
    EXPECT_EQ(help.find("--json") != std::string::npos, c.writes != Writes::kFiles) << c.words;
    EXPECT_EQ(help.find("--fail-on") != std::string::npos,
              c.writes == Writes::kVerdict || c.writes == Writes::kFigures)
        << c.words;
  }
  /// Forced, with the document on standard output, its origin, and its verdict as exit code.
  void expectDocument(const Case& c) const {
    const bool verdict = c.writes == Writes::kVerdict;
    const Outcome piped = run(c, std::string(" --force --json -") +
                                     (verdict ? " --fail-on caution" : "") + " 2>/dev/null");
    const json document = json::parse(piped.text, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << c.words << ": " << piped.text.substr(0, 300);
    if (!verdict || document.is_discarded()) {
      EXPECT_EQ(piped.exit_code, 0) << c.words;
      return;
    }
    const std::string level = document["verdict"]["level"];
    EXPECT_EQ(piped.exit_code, level == "good" ? 0 : 4) << c.words << ": " << level;
    EXPECT_THAT(document["verdict"]["headline"], Not(testing::IsEmpty())) << c.words;
    const json& origin = document["provenance"];
    EXPECT_THAT(origin["command"], HasSubstr("plumbline " + c.words + " ")) << c.words;
    EXPECT_THAT(origin["command"], HasSubstr("--json -")) << c.words << ": all of the arguments";
    EXPECT_THAT(origin["plumbline"], testing::MatchesRegex("[0-9.]+( \\([0-9a-f+dirty-]+\\))?"));
    EXPECT_THAT(origin["input_hash"], HasSubstr("xxh64:")) << c.words;
  }
};

TEST_F(EveryCommand, IsInTheTable) {
  std::set<std::string> known = {"study", "study accept", "completion", "man"};  // see below
  for (const Case& c : cases()) known.insert(c.words);
  EXPECT_EQ(allCommands(), known);
}

TEST_F(EveryCommand, ReplacesAResultOnlyWhenForcedAndGivesItsDocumentWithOriginAndVerdict) {
  for (const Case& c : cases()) {
    expectOptionsInHelp(c);
    fs::create_directories(scratch());
    const Outcome first = run(c, "");
    EXPECT_EQ(first.exit_code, 0) << c.words << ": " << first.text;
    EXPECT_TRUE(fs::exists(scratch() / c.out)) << c.words;
    EXPECT_THAT(first.text, Not(HasSubstr("\033["))) << c.words << ": colours in a pipe";
    const Outcome again = run(c, "");
    EXPECT_EQ(again.exit_code, 2) << c.words << ": " << again.text;
    EXPECT_THAT(again.text, HasSubstr("--force")) << c.words;
    if (c.writes == Writes::kFiles) {
      const Outcome forced = run(c, " --force");
      EXPECT_EQ(forced.exit_code, 0) << c.words << ": " << forced.text;
    } else {
      expectDocument(c);
    }
    fs::remove_all(scratch());
  }
}

TEST_F(EveryCommand, AStudyHasThemToo) {
  const std::string study = "study " + at("study/STUDY.yaml") + " --out " + at("night");
  const Outcome night = plumbline(study + " --json - --fail-on caution 2>/dev/null");
  const json document = json::parse(night.text, nullptr, false);
  ASSERT_FALSE(document.is_discarded()) << night.text.substr(0, 300);
  EXPECT_EQ(night.exit_code, document["verdict"]["level"] == "good" ? 0 : 4);
  EXPECT_EQ(night.text, read(root_ / "night/summary.json"));
  EXPECT_THAT(document["provenance"]["command"], HasSubstr("--fail-on caution"));
  const Outcome packed = plumbline(study + " --engine commands --json -");
  EXPECT_EQ(packed.exit_code, 2) << packed.text;
}

// On a terminal a verdict has a colour, unless NO_COLOR says otherwise.
TEST_F(EveryCommand, ColoursStandOnTerminalsAlone) {
  ASSERT_EQ(shell("command -v script").exit_code, 0) << "install bsdutils";
  fs::create_directories(scratch());
  const auto onTerminal = [&](const std::string& environment) {
    return shell(environment + " script -qec '" + std::string(PLUMBLINE_BINARY) + " calibrate " +
                 at("session") + kAsStated + " --no-imu --no-cache --no-report --force --out " +
                 (scratch() / "out").string() + "' /dev/null")
        .text;
  };
  EXPECT_THAT(onTerminal("env -u NO_COLOR"), HasSubstr("\033[3"));
  EXPECT_THAT(onTerminal("NO_COLOR=1"), Not(HasSubstr("\033[3")));
}

}  // namespace
}  // namespace plumbline
