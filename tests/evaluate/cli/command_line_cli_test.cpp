// SPDX-License-Identifier: BSD-3-Clause
// The program as a user runs it: exit codes, messages, files left behind.
#include <sstream>
#include <string>
#include <vector>

#include <sys/stat.h>

#include "evaluate/cli/options/simulation_options.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

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
  for (const char* of_imu : {"--joint", "--imu-shift-ms 5"}) {
    expectRefusal(calibrate(session(), std::string("--no-imu ") + of_imu), 2,
                  HasSubstr("--no-imu excludes --"));
  }
  expectRefusal(calibrate(session(), "--stride 2 --stride 3"), 2,
                HasSubstr("--stride is given 2 times; expected once"));
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
         {"export " + file + " --to kalibr" + out, "report " + file + out + ".html",
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
  for (const std::string& words :
       {"simulate --rig unknown" + out, "simulate --motion circle" + out, "detect /nowhere" + out,
        "calibrate /nowhere" + out, "report /nowhere" + out + ".html",
        "report " + session().string() + out + ".html"}) {
    expectRefusal(plumbline(words), 2, testing::Not(IsEmpty()));
  }
}

TEST_F(CommandLine, SimulateNamesTheOptionThatIsOutOfRange) {
  expectRange("simulate", "--duration", {"0.001", "100000"}, {"0", "nan"});
  expectRange("simulate", "--camera-rate", {"0.001", "100000"}, {"0", "nan"});
  expectRange("simulate", "--imu-rate", {"0.001", "100000"}, {"0", "nan"});
  expectRange("simulate", "--time-offset-ms", {"-1e+06", "1e+06"}, {"-1.1e6", "nan"});
  expectRange("simulate", "--corner-sigma", {"0", "1000"}, {"-1", "nan"});
  expectRange("simulate", "--outliers", {"0", "1"}, {"-1", "2"});
  const std::string study = "simulate study --out " + (scratch() / "out").string();
  expectRefusal(plumbline(study + " --learning 9"), 2,
                HasSubstr("--learning: 9: expected 0.1 to 1"));
  expectRefusal(plumbline(study + " --participants 0"), 2,
                HasSubstr("--participants: 0: expected 1 to 1000"));
  expectRefusal(plumbline(study + " --threads"), 2, HasSubstr("--threads: expected a value"));
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

}  // namespace
}  // namespace plumbline
