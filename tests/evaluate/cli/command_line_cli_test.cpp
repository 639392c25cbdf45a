// SPDX-License-Identifier: BSD-3-Clause
// The program as a user runs it: exit codes, messages, files left behind.
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <sys/stat.h>

#include "evaluate/cli/options/simulation_options.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

// The whole number after the first `words`; -1 without them.
int numberAfter(const std::string& text, const std::string& words) {
  const auto at = text.find(words);
  return at == std::string::npos ? -1 : std::atoi(text.c_str() + at + words.size());
}

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// Expects help with an example of `words` and of all commands within; how many do something.
int expectHelp(const std::string& words) {
  const Outcome outcome = plumbline(words + " --help");
  EXPECT_EQ(outcome.exit_code, 0) << words;
  EXPECT_THAT(outcome.text, HasSubstr("plumbline " + words)) << words;
  EXPECT_THAT(outcome.text, HasSubstr("Example")) << words;
  const auto within = listedCommands(outcome.text);
  int commands = within.empty() ? 1 : 0;
  for (const std::string& name : within) commands += expectHelp(words + " " + name);
  return commands;
}

TEST_F(CommandLine, EveryCommandHasHelpWithAnExample) {
  int commands = 0;
  for (const std::string& name : listedCommands(plumbline("--help").text)) {
    commands += expectHelp(name);
  }
  EXPECT_GE(commands, 11) << "the list was not read";
  EXPECT_EQ(plumbline("--version").exit_code, 0);
}

TEST_F(CommandLine, HelpOfSimulateHasEveryTermOfABoard) {
  const std::string help = plumbline("simulate --help").text;
  std::istringstream terms(targetShapeExample());
  for (std::string term; std::getline(terms, term, ',');) EXPECT_THAT(help, HasSubstr(term));
}

TEST_F(CommandLine, AMistypedWordIsRecognised) {
  EXPECT_THAT(plumbline("calibrat").text, HasSubstr("did you mean calibrate?"));
  EXPECT_THAT(plumbline("simulate --out x --durration 3").text,
              HasSubstr("did you mean --duration?"));
  EXPECT_THAT(plumbline("--nonsense").text, testing::Not(HasSubstr("did you mean")));
  // --fit of compare is in no help.
  EXPECT_THAT(plumbline("compare a b --out x --fitt squares").text,
              testing::Not(HasSubstr("mean --fit?")));
}

TEST_F(CommandLine, CompletionKnowsEveryCommandAndItsOptions) {
  const Outcome bash = plumbline("completion bash");
  ASSERT_EQ(bash.exit_code, 0);
  fs::create_directories(scratch());
  const fs::path file = scratch() / "completion.bash";
  write(file, bash.text);
  const auto completed = [&](const std::string& words) {
    return shell("bash -c 'source " + file.string() + "; COMP_WORDS=(plumbline " + words +
                 "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _plumbline; echo ${COMPREPLY[@]}'")
        .text;
  };
  EXPECT_EQ(completed("evaluate calibration --fol"), "--folds\n");
  // A value that is named like a subcommand.
  EXPECT_EQ(completed("simulate --out study --moti"), "--motion\n");
  const std::string fish = plumbline("completion fish").text;
  const std::string zsh = plumbline("completion zsh").text;
  const std::string man = plumbline("man").text;
  for (const std::string& name : listedCommands(plumbline("--help").text)) {
    EXPECT_THAT(fish, HasSubstr("-a " + name + " "));
    EXPECT_THAT(zsh, HasSubstr("'" + name + ":"));
    EXPECT_THAT(man, HasSubstr(".SS plumbline " + name));
  }
  EXPECT_EQ(plumbline("completion tcsh").exit_code, 2);
}

#define NEED_SHELL(name)                            \
  ASSERT_EQ(shell("command -v " name).exit_code, 0) \
      << name " is missing: its completion cannot be asked; scripts/test.sh installs it"

TEST_F(CommandLine, FishCompletesCommandsAndOptions) {
  NEED_SHELL("fish");
  fs::create_directories(scratch());
  const fs::path file = scratch() / "plumbline.fish";
  write(file, plumbline("completion fish").text);
  const auto completed = [&](const std::string& line) {
    // Candidates, each with its description after a tab.
    const Outcome out = shell("HOME=" + scratch().string() + " fish --no-config -c 'source " +
                              file.string() + "; complete -C \"plumbline " + line + "\"'");
    return out.text;
  };
  EXPECT_THAT(completed("calib"), testing::StartsWith("calibrate\tCalibrate"));
  EXPECT_THAT(completed("evaluate calibration --fol"), testing::StartsWith("--folds\t"));
  EXPECT_THAT(completed("evaluate traj"), HasSubstr("trajectory\t"));
  EXPECT_EQ(completed("evaluate calibration --part"), "");  // simulate study's
  EXPECT_THAT(completed("simulate study --part"), testing::StartsWith("--participants\t"));
  EXPECT_EQ(completed("study --part"), "") << "the command study is not simulate study";
  EXPECT_THAT(completed("simulate --out study --moti"), testing::StartsWith("--motion\t"));
}

TEST_F(CommandLine, ZshCompletesCommandsAndOptions) {
  NEED_SHELL("zsh");
  fs::create_directories(scratch() / "functions");
  write(scratch() / "functions" / "_plumbline", plumbline("completion zsh").text);
  write(scratch() / "sourced.zsh", plumbline("completion zsh").text);
  // A terminal in which a line is typed, a tab, and what then stands there is printed.
  const auto completed = [&](const std::string& line, bool sourced) {
    const std::string folder = scratch().string();
    const std::string load =
        sourced
            ? "autoload -Uz compinit; compinit -u -d " + folder + "/dump1; source " + folder +
                  "/sourced.zsh"
            : "fpath=(" + folder + "/functions $fpath); autoload -Uz compinit; compinit -u -d " +
                  folder + "/dump2";
    write(scratch() / "ask.zsh",
          "zmodload zsh/zpty\nzpty line zsh -f -i\n"
          "zpty -w line 'PS1=; TERM=dumb; unsetopt zle_bracketed_paste; " +
              load +
              "; show() { print -r -- \"<$BUFFER>\"; BUFFER=; zle accept-line }; zle -N show; "
              "bindkey \"^I\" complete-word \"^X\" show; print ready'\n"
              "zpty -r line out '*ready*ready*'\n"
              "zpty -w -n line $'plumbline " +
              line +
              "\\t\\x18'\n"
              "zpty -r line out '*<*>*'\nprint -r -- \"${${out##*<}%%>*}\"\nzpty -d line\n");
    return shell("cd " + folder + " && timeout 300 zsh -f ask.zsh").text;
  };
  for (const bool sourced : {true, false}) {
    EXPECT_EQ(completed("calib", sourced), "plumbline calibrate \n");
    EXPECT_EQ(completed("evaluate calibration --fol", sourced),
              "plumbline evaluate calibration --folds \n");
    EXPECT_EQ(completed("simulate study --part", sourced),
              "plumbline simulate study --participants \n");
    EXPECT_EQ(completed("simulate --out study --moti", sourced),
              "plumbline simulate --out study --motion \n");
  }
}

TEST_F(CommandLine, FailOnTurnsTheVerdictIntoTheExitCode) {
  const auto codeOf = [&](const std::string& words) {
    return calibrateAsStated(session(), "--no-imu --no-report " + words).exit_code;
  };
  const std::string strict = "--threshold rmse_px=0.001,1000 ";  // caution
  EXPECT_EQ(codeOf(strict), 0);
  EXPECT_EQ(codeOf(strict + "--fail-on caution"), 4);
  EXPECT_EQ(codeOf(strict + "--fail-on bad"), 0);
  EXPECT_EQ(codeOf("--threshold rmse_px=0.001,0.002 --fail-on bad"), 4);
  EXPECT_EQ(codeOf("--fail-on good"), 2);
}

TEST_F(CommandLine, JsonMeansTheSameInEveryCommand) {
  const fs::path result = scratch() / "out";
  const std::string document =
      calibrateAsStated(session(), "--no-imu --no-report --json - 2>/dev/null").text;
  EXPECT_EQ(document, read(result / "calibration.json")) << "and nothing else";
  const fs::path copy = scratch() / "copy.json";
  ASSERT_EQ(calibrateAsStated(session(), "--no-imu --no-report --json " + copy.string()).exit_code,
            0);
  EXPECT_EQ(read(copy), read(result / "calibration.json"));
  EXPECT_EQ(
      calibrateAsStated(session(), "--no-imu --json " + (result / "in.json").string()).exit_code,
      2);
}

TEST_F(CommandLine, UsageErrorsExitWithTwo) {
  EXPECT_EQ(plumbline("").exit_code, 2);
  EXPECT_EQ(plumbline("calibrat").exit_code, 2);
  EXPECT_EQ(plumbline("calibrate").exit_code, 2);
  EXPECT_EQ(plumbline("calibrate session --out x --unknown").exit_code, 2);
  expectRefusal(calibrate(session(), "--loss huber"), 2, HasSubstr("cauchy:1.5"));
  expectRefusal(calibrate(session(), "--stride 0"), 2, HasSubstr("--stride"));
  expectRefusal(calibrate(session(), "--only cam7"), 2, HasSubstr("cam0, cam1"));
  expectRefusal(calibrate(session(), "--models omni-fov"), 2,
                AllOf(HasSubstr("--models omni-fov"), HasSubstr("pinhole-equidistant")));
  expectRefusal(calibrate(session(), "--seed -1"), 2, HasSubstr("--seed"));
  expectRefusal(plumbline("simulate --seed -1 --out " + (scratch() / "out").string()), 2,
                HasSubstr("--seed"));
  const std::string faulty = "simulate --out " + (scratch() / "out").string() + " --fault ";
  expectRefusal(plumbline(faulty + "gyro-lag=5ms"), 2,
                AllOf(HasSubstr("gyro-lag=5ms"), HasSubstr("gyro-delay")));
  expectRefusal(plumbline(faulty + "gyro-delay=5"), 2, HasSubstr("gyro-delay=TIME"));
  expectRefusal(plumbline(faulty + "slip=1deg@99s"), 2, HasSubstr("slip=1deg@99s"));
  expectRefusal(plumbline(faulty + "bow=1mm --images"), 2, HasSubstr("bow=1mm"));
  expectRefusal(plumbline("simulate"), 2, HasSubstr("--out"));
  expectRefusal(calibrate("/nowhere"), 2, HasSubstr("/nowhere"));
  // A list takes no word behind it: that is the session.
  const std::string out = " --out " + (scratch() / "out").string();
  expectRefusal(plumbline("calibrate --only cam7 " + session().string() + out), 2,
                HasSubstr("cam0, cam1"));
  for (const char* words : {"evaluate calibration --held-out a /nowhere/b /nowhere/c",
                            "replay --latency-ms camera-frame=5 /nowhere/b"}) {
    expectRefusal(plumbline(words + out), 2, HasSubstr("/nowhere/b"));
  }
}

TEST_F(CommandLine, OptionsThatWouldBeCutOrMeanNothingAreRefused) {
  for (const char* command : {"calibrate ", "perturb --offsets-ms 1 ", "replay "}) {
    expectRefusal(plumbline(command + session().string() +
                            " --models pinhole-equidistant --cameras file.yaml --out " +
                            (scratch() / "out").string()),
                  2, AllOf(HasSubstr("--cameras"), HasSubstr("--models")));
  }
  for (const char* seed : {"99999999999999999999999", "1.5", "18446744073709551616", "1e3"}) {
    expectRefusal(calibrate(session(), std::string("--seed ") + seed), 2,
                  AllOf(HasSubstr("--seed"), HasSubstr("expected a whole number")));
    expectRefusal(plumbline(std::string("simulate --seed ") + seed + " --out " +
                            (scratch() / "out").string()),
                  2, HasSubstr("--seed"));
  }
  expectRefusal(calibrate(session(), "--threshold rmse_px=2,1"), 2,
                AllOf(HasSubstr("--threshold rmse_px=2,1"), HasSubstr("BAD the larger")));
  expectRefusal(calibrate(session(), "--threshold coverage=0.5,0.75"), 2,
                HasSubstr("BAD the smaller"));
  const std::string out = " --out " + (scratch() / "out").string();
  // What stands before a subcommand is no option of it.
  expectRefusal(plumbline("simulate --seed 7 sequence" + out), 2,
                AllOf(HasSubstr("--seed"), HasSubstr("after sequence")));
  expectRefusal(plumbline("study --jobs 2 accept night"), 2, HasSubstr("--jobs"));
  // Of corners or tracks, which images do not have; and the other way round.
  for (const char* words : {" --images --outliers 0.1", " --images --corner-sigma 0.5",
                            " sequence --images --outliers 0.1", " sequence --images --tracks 50",
                            " sequence --images --track-sigma 1", " sequence --exposure-ms 2"}) {
    expectRefusal(plumbline("simulate" + std::string(words) + out), 2, HasSubstr("--images"));
  }
}

TEST_F(CommandLine, PipesAndDevicesAreRefusedAtOnce) {
  fs::create_directories(scratch());
  const fs::path pipe = scratch() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string out = " --out " + (scratch() / "out").string();
  for (const std::string& file : {pipe.string(), std::string("/dev/zero"), session().string()}) {
    for (const std::string& words :
         {"export " + file + " --to kalibr" + out, "report " + file + out,
          "evaluate trajectory " + file + " " + file + out,
          "calibrate " + session().string() + " --target " + file + out,
          "calibrate " + session().string() + " --imu " + file + out}) {
      if (words.find("report " + session().string()) == 0) continue;  // a folder may be its input
      expectRefusal(plumbline(words), 2, HasSubstr(file));
    }
  }
}

TEST_F(CommandLine, TextsOfFilesAreShownEscaped) {
  const fs::path copy = spoiled();
  write(copy / "target.yaml", "target_type: \"\\e[31mred\\u202e\"\n");
  expectRefusal(calibrate(copy), 2, HasSubstr("'\\x1b[31mred\\u202e'"));
  expectRefusal(
      plumbline("export $(printf 'na\\357ve') --to kalibr --out " + (scratch() / "out").string()),
      2, AllOf(HasSubstr("na\\xefve"), HasSubstr("not UTF-8")));
}

TEST_F(CommandLine, EveryCommandExitsWithTwoOnBadInput) {
  const std::string out = " --out " + (scratch() / "out").string();
  for (const std::string& words : {"simulate --rig unknown" + out, "simulate --motion circle" + out,
                                   "detect /nowhere" + out, "calibrate /nowhere" + out,
                                   "report /nowhere" + out, "report " + session().string() + out}) {
    expectRefusal(plumbline(words), 2, testing::Not(IsEmpty()));
  }
}

TEST_F(CommandLine, FaultsAreListedAndMayBeRepeated) {
  const Outcome list = plumbline("simulate --fault list");
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.text, AllOf(HasSubstr("gyro-delay=TIME"), HasSubstr("swapped-ids=SHARE")));
  const Outcome outcome =
      plumbline("simulate --duration 5 --fault gyro-delay=5ms --fault burst --out " +
                (scratch() / "out").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(read(scratch() / "out/truth/truth.json"),
              AllOf(HasSubstr("\"gyro-delay=5ms\""), HasSubstr("\"burst\"")));
}

// ---- options that choose data

TEST_F(CommandLine, OnlyTheCamerasAskedForAreCalibrated) {
  const Outcome outcome = calibrateAsStated(session(), "--only cam1 --no-imu --no-report");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string json = read(scratch() / "out/calibration.json");
  EXPECT_THAT(json, HasSubstr("\"cam1.fu\""));
  EXPECT_THAT(json, testing::Not(HasSubstr("cam0.fu")));
}

TEST_F(CommandLine, SelectedViewsAreFewerAndTheSeedIsKept) {
  const Outcome outcome = calibrateAsStated(
      session(), "--only cam0 --no-imu --no-report --select-views mi:0.2bits --seed 9");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string json = read(scratch() / "out/calibration.json");
  const int used = numberAfter(json, "\"views_used\": ");
  EXPECT_GE(used, 5);
  EXPECT_LT(4 * used, numberAfter(json, "\"views_offered\": "));
  EXPECT_THAT(json, HasSubstr("\"--seed\": \"9\""));
}

TEST_F(CommandLine, ResamplingReportsItsSpread) {
  const Outcome outcome =
      calibrateAsStated(session(), "--only cam0 --no-imu --no-report --resample 4");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string json = read(scratch() / "out/calibration.json");
  EXPECT_EQ(numberAfter(json, "\"resamples\": "), 4);
  fs::remove_all(scratch());
  expectRefusal(calibrateAsStated(session(), "--resample 1"), 2, HasSubstr("--resample"));
}

TEST_F(CommandLine, MoreCornersThanAViewHoldsAreAskedForByOption) {
  expectRefusal(calibrate(session(), "--min-corners 200"), 1,
                AllOf(HasSubstr("--min-corners 200"), HasSubstr("at least 200 corners"),
                      HasSubstr("most in one view is 144")));
}

TEST_F(CommandLine, EveryFileReadIsInTheHash) {
  const auto hash = [&](const std::string& options) {
    const Outcome outcome = calibrate(session(), "--to 6 --no-halves --no-report " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    const std::string json = read(scratch() / "out/calibration.json");
    return json.substr(json.find("xxh64:"), 22);
  };
  const std::string stated = "--models pinhole-radtan ", plain = hash(stated);
  fs::rename(scratch() / "out", scratch() / "first");
  const fs::path camchain = scratch() / "first/camchain-imucam.yaml";
  const std::string given = hash("--cameras " + camchain.string());
  write(camchain, read(camchain) + "\n# another file\n");
  const std::string changed = hash("--cameras " + camchain.string());
  const fs::path imu = scratch() / "imu.yaml";
  write(imu, read(session() / "imu.yaml") + "# another\n");
  EXPECT_EQ(
      (std::set<std::string>{plain, given, changed, hash(stated + "--imu " + imu.string())}).size(),
      4U);
}

// All that a calibration does unless told otherwise, once: lens models are chosen, halves compared.
TEST_F(CommandLine, CalibrateLeavesAllResultsWhateverTheThreadsAndTheRecordingAsItWas) {
  const auto before = contents(session());
  const Outcome outcome = calibrate(session(), "--residuals --threads 3");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text,
              AllOf(HasSubstr("T_SC0"), HasSubstr("Verdict"), HasSubstr("report.html")));
  EXPECT_EQ(contents(session()), before);
  std::vector<std::string> names;
  for (const auto& [name, text] : contents(scratch() / "out")) {
    names.push_back(name);
    EXPECT_THAT(text, testing::Not(IsEmpty())) << name;
  }
  EXPECT_THAT(names,
              testing::UnorderedElementsAre("calibration.json", "camchain-imucam.yaml", "imu.yaml",
                                            "records.sqlite", "report.html", "residuals.csv"));
  const std::string three = read(scratch() / "out/camchain-imucam.yaml");
  ASSERT_EQ(calibrate(session(), "--threads 1 --no-report").exit_code, 0);
  EXPECT_EQ(read(scratch() / "out/camchain-imucam.yaml"), three);
}

TEST_F(CommandLine, ReportIsMadeAgainFromTheRecordsAlone) {
  // With halves to compare and a lens model to choose, of one camera.
  ASSERT_EQ(calibrate(session(), "--only cam0").exit_code, 0);
  const fs::path out = scratch() / "out", again = scratch() / "again.html";
  const std::string page = read(out / "report.html");
  const Outcome outcome = plumbline("report " + out.string() + " --out " + again.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(read(again), page);
  EXPECT_EQ(plumbline("report " + session().string() + " --out x.html").exit_code, 2);
  const std::string document = read(out / "calibration.json");
  const Outcome piped = plumbline("report " + out.string() + " --json - 2>/dev/null");
  EXPECT_EQ(piped.exit_code, 0);
  EXPECT_EQ(piped.text, document);
  const fs::path file = scratch() / "again.json";
  ASSERT_EQ(plumbline("report " + out.string() + " --json " + file.string()).exit_code, 0);
  EXPECT_EQ(read(file), document);
  EXPECT_EQ(plumbline("report " + out.string()).exit_code, 2);
}

TEST_F(CommandLine, ResultsAreWrittenTogetherOrNotAtAll) {
  const fs::path out = scratch() / "out";
  fs::create_directories(out / "report.html");
  write(out / "calibration.json", "earlier");
  const Outcome outcome = calibrateAsStated(session());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("calibration.json: was not written by plumbline"));
  EXPECT_EQ(read(out / "calibration.json"), "earlier");
  EXPECT_EQ(contents(out).size(), 1U);
  fs::remove_all(out);
  ASSERT_EQ(calibrateAsStated(session()).exit_code, 0);
  for (const auto& [name, text] : contents(out)) EXPECT_EQ(name.find('.') == 0, false) << name;
  ASSERT_EQ(calibrateAsStated(session(), "--no-imu --no-report").exit_code, 0);
  for (const char* name : {"report.html", "imu.yaml", "camchain-imucam.yaml"}) {
    EXPECT_FALSE(fs::exists(out / name)) << name << " is of an earlier run";
  }
}

TEST_F(CommandLine, ItsOwnCalibrationIsAStartForTheNext) {
  ASSERT_EQ(calibrateAsStated(session(), "--no-report").exit_code, 0);
  fs::rename(scratch() / "out", scratch() / "first");
  for (const char* file : {"calibration.json", "camchain-imucam.yaml"}) {
    const Outcome outcome = calibrate(
        session(), "--no-halves --no-report --cameras " + (scratch() / "first" / file).string());
    EXPECT_EQ(outcome.exit_code, 0) << file << outcome.text;
    EXPECT_EQ(read(scratch() / "out/imu.yaml"), read(scratch() / "first/imu.yaml"));
  }
}

TEST_F(CommandLine, MissingPiecesAreNamed) {
  for (const char* name : {"target.yaml", "imu.yaml", "mav0/cam1/sensor.yaml"}) {
    const fs::path copy = spoiled();
    fs::remove(copy / name);
    if (std::string(name) == "imu.yaml") fs::remove(copy / "mav0/imu0/sensor.yaml");
    expectRefusal(calibrate(copy), 2, HasSubstr(fs::path(name).filename().string()));
    fs::remove_all(scratch());
  }
}

TEST_F(CommandLine, FaultyRowsAreNamedByFileAndLine) {
  const fs::path copy = spoiled();
  const fs::path csv = copy / "mav0/imu0/data.csv";
  const std::string good = read(csv);
  const auto second_row = good.find('\n', good.find('\n') + 1) + 1;
  const std::map<std::string, std::string> faults{
      {good.substr(0, second_row) + "abc,1,2,3,4,5,6\n" + good.substr(second_row), ":3:"},
      {good.substr(0, second_row) + "1,nan,2,3,4,5,6\n" + good.substr(second_row), ":3:"},
      {good + good.substr(second_row, 60), "data.csv:"},
      {"", "data.csv"}};
  for (const auto& [text, words] : faults) {
    write(csv, text);
    expectRefusal(calibrateAsStated(copy), 2, AllOf(HasSubstr("imu0/data.csv"), HasSubstr(words)));
  }
}

TEST_F(CommandLine, GivenCamerasAreBlamedForPosesThatTheySpoil) {
  const std::string truth = read(session() / "truth/camchain-imucam.yaml");
  fs::create_directories(scratch());
  const fs::path file = scratch() / "equidistant.yaml";
  write(file, replaced(replaced(truth, "radtan", "equidistant"), "radtan", "equidistant"));
  expectRefusal(calibrate(session(), "--no-halves --cameras " + file.string()), 2,
                AllOf(HasSubstr("the given cameras do not explain the corners"),
                      HasSubstr("--free-cameras")));
  // What is found in the stamps stands on no poses: it is said as with good cameras.
  const Outcome apart =
      calibrate(session(), "--no-halves --imu-shift-ms 1e6 --cameras " + file.string());
  EXPECT_EQ(apart.exit_code, 1) << apart.text;
  EXPECT_THAT(apart.text, Not(HasSubstr("do not explain the corners")));
}

TEST_F(CommandLine, WrongTargetSizeIsFoundByTheImu) {
  const fs::path copy = spoiled();
  const std::string target = read(copy / "target.yaml");
  write(copy / "target.yaml", replaced(target, "0.088", "0.110"));
  expectRefusal(calibrateAsStated(copy), 2,
                AllOf(HasSubstr("target.yaml:4:"), HasSubstr("tagSize")));
}

TEST_F(CommandLine, CameraWithoutDetectionsIsNamed) {
  const fs::path copy = spoiled();
  write(copy / "mav0/cam1/corners.csv", "#timestamp [ns],corner_id,u [px],v [px]\n");
  expectRefusal(calibrateAsStated(copy), 1, HasSubstr("cam1"));
}

TEST_F(CommandLine, TooFewViewsAreRefused) {
  expectRefusal(calibrate(session(), "--to 0.06"), 1, HasSubstr("view"));
}

}  // namespace
}  // namespace plumbline
