// SPDX-License-Identifier: BSD-3-Clause
// `plumbline evaluate trajectory` as a user runs it.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class CommandTrajectory : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("plumbline_trajectory_" + std::to_string(getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    write(folder_ / "truth.txt", circle(100, 1));
    write(folder_ / "estimate.txt", circle(100, 1.01));
  }
  void TearDown() override { fs::remove_all(folder_); }

  // TUM at 20 Hz from `start` [s]: a circle of radius `radius`; a line for radius 0.
  static std::string circle(double start, double radius) {
    std::string text = "# timestamp tx ty tz qx qy qz qw\n";
    for (int i = 0; i < 100; ++i) {
      const double a = 0.05 * i;
      char line[200];
      std::snprintf(line, sizeof line, "%.9f %.9f %.9f 0 0 0 %.9f %.9f\n", start + a,
                    radius > 0 ? radius * std::cos(a) : a, radius * std::sin(a), std::sin(a / 2),
                    std::cos(a / 2));
      text += line;
    }
    return text;
  }
  Outcome run(const std::string& options = "") const {
    return plumbline("evaluate trajectory " + (folder_ / "estimate.txt").string() + " " +
                     (folder_ / "truth.txt").string() + " " + options);
  }
  void expectRefusal(const Outcome& outcome, int exit_code,
                     const testing::Matcher<std::string>& words) const {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.text;
    EXPECT_THAT(outcome.text, words);
    EXPECT_EQ(outcome.text.find("plumbline: "), 0U) << outcome.text;
    EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
  }

  fs::path truth() const { return folder_ / "truth.txt"; }
  fs::path estimate() const { return folder_ / "estimate.txt"; }

  fs::path folder_;
};

TEST_F(CommandTrajectory, PrintsATableAndWritesTheFigures) {
  const fs::path json = folder_ / "figures.json";
  const Outcome outcome = run("--align none --rpe 1m,1frames --json " + json.string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("rmse"), HasSubstr("ATE translation [m]"),
                                  HasSubstr("RPE 1 frames rotation [deg]"),
                                  HasSubstr("100 pairs of 100 estimated and 100 true poses")));
  const auto figures = nlohmann::json::parse(read(json));
  EXPECT_NEAR(figures["ate"]["translation_m"]["rmse"], 0.01, 1e-8);
  EXPECT_EQ(figures["rpe"].size(), 2U);
  EXPECT_EQ(figures["verdict"]["level"], "good");
  EXPECT_EQ(figures["provenance"]["input"], "estimate.txt against truth.txt");
  EXPECT_EQ(nlohmann::json::parse(run("--json -").text)["alignment"], "se3");
}

TEST_F(CommandTrajectory, WritesNoPageWhereNoneIsWanted) {
  const fs::path out = folder_ / "no_page";
  const Outcome outcome = run("--no-report --out " + out.string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("no_page/trajectory.json"));
  EXPECT_TRUE(fs::exists(out / "trajectory.json"));
  EXPECT_FALSE(fs::exists(out / "report.html"));
}

TEST_F(CommandTrajectory, PairsOfToolsAreNamed) {
  const auto rpe = [&](const std::string& pairs) {
    return nlohmann::json::parse(run("--rpe 1m --rpe-pairs " + pairs + " --json -").text)["rpe"][0];
  };
  EXPECT_EQ(rpe("evo")["pairs"], "evo");
  EXPECT_LT(rpe("evo")["translation_m"]["n"], 6);  // one after the other on 5 m
  EXPECT_GT(rpe("plumbline")["translation_m"]["n"], 70);
  EXPECT_GT(rpe("ov_eval")["translation_m"]["n"], rpe("rpg")["translation_m"]["n"]);
}

TEST_F(CommandTrajectory, Sim3FindsTheScale) {
  const auto figures = nlohmann::json::parse(run("--align sim3 --json -").text);
  EXPECT_NEAR(figures["scale"], 1 / 1.01, 1e-8);
  EXPECT_LT(figures["ate"]["translation_m"]["rmse"], 1e-8);
}

TEST_F(CommandTrajectory, SaysWhereTheEstimateDiverged) {
  write(estimate(), circle(100, 50));
  const auto figures = nlohmann::json::parse(run("--json -").text);
  EXPECT_EQ(figures["status"], "partial");
  EXPECT_THAT(figures["problem"], HasSubstr("diverged: ATE"));
  EXPECT_GT(figures["ate"]["translation_m"]["rmse"], 0) << "its errors stay, however large";
  EXPECT_EQ(figures["verdict"]["level"], "caution");
  EXPECT_EQ(nlohmann::json::parse(run("--max-ate 100 --json -").text)["status"], "complete");
}

TEST_F(CommandTrajectory, AnEstimateMayComeFromAPipe) {
  const std::string piped = "evaluate trajectory - " + truth().string() + " --json - < ";
  EXPECT_EQ(nlohmann::json::parse(plumbline(piped + estimate().string()).text)["n"],
            nlohmann::json::parse(run("--json -").text)["n"]);
}

TEST_F(CommandTrajectory, FiguresAreNeverWrittenOverAnInputOrAnythingForeign) {
  const std::string before = read(truth());
  EXPECT_EQ(run("--json " + truth().string() + " --force").exit_code, 2);
  fs::create_symlink(truth(), folder_ / "alias.json");
  EXPECT_EQ(run("--json " + (folder_ / "alias.json").string() + " --force").exit_code, 2);
  EXPECT_EQ(read(truth()), before);
  write(folder_ / "notes.json", "mine");
  EXPECT_EQ(run("--json " + (folder_ / "notes.json").string() + " --force").exit_code, 2);
  EXPECT_EQ(read(folder_ / "notes.json"), "mine");
  const std::string figures = "--json " + (folder_ / "figures.json").string();
  EXPECT_EQ(run(figures).exit_code, 0);
  EXPECT_EQ(run(figures).exit_code, 2);
  EXPECT_EQ(run(figures + " --force").exit_code, 0);
  EXPECT_EQ(run("--json /dev/null").exit_code, 2);
}

TEST_F(CommandTrajectory, NoOverlapNamesTheFilesAndTheCause) {
  write(folder_ / "truth.txt", circle(1.4e9, 1));
  expectRefusal(run(), 1,
                AllOf(HasSubstr("estimate.txt"), HasSubstr("truth.txt"),
                      HasSubstr("no overlap in time"), HasSubstr("1970")));
}

TEST_F(CommandTrajectory, PositionsOnALineAreRefusedUnlessTheAlignmentBearsThem) {
  write(folder_ / "truth.txt", circle(100, 0));
  write(folder_ / "estimate.txt", circle(100, 0));
  expectRefusal(run(), 1, AllOf(HasSubstr("estimate.txt"), HasSubstr("on a line")));
  EXPECT_EQ(run("--align yaw").exit_code, 0);
  EXPECT_EQ(run("--align se3-first").exit_code, 0);
}

TEST_F(CommandTrajectory, BadOptionsAndFilesExitWithTwo) {
  expectRefusal(run("--align rigid"), 2, AllOf(HasSubstr("--align rigid"), HasSubstr("se3-first")));
  expectRefusal(run("--association nearest"), 2, HasSubstr("one-to-one"));
  expectRefusal(run("--rpe 10miles"), 2, HasSubstr("10m"));
  expectRefusal(run("--rpe 1.5frames"), 2, HasSubstr("1.5frames"));
  expectRefusal(run("--rpe-pairs kitti"), 2, HasSubstr("ov_eval"));
  expectRefusal(run("--rpe 1frames --rpe-pairs rpg"), 2, HasSubstr("frames"));
  expectRefusal(run("--max-dt -1"), 2, HasSubstr("--max-dt"));
  expectRefusal(run("--format csv"), 2, HasSubstr("motive"));
  // Without what they are of they would be without effect.
  expectRefusal(run("--no-report"), 2, HasSubstr("--out"));
  expectRefusal(run("--clock-range 5"), 2, HasSubstr("--clock-offset auto"));
  expectRefusal(run("--clock-range 5 --clock-offset 0.1"), 2, HasSubstr("--clock-offset auto"));
  expectRefusal(plumbline("evaluate"), 2, Not(HasSubstr("unexpected")));
  expectRefusal(plumbline("evaluate trajectory"), 2,
                HasSubstr("plumbline evaluate trajectory --help"));
  expectRefusal(plumbline("evaluate trajectory /nowhere /nowhere"), 2, HasSubstr("/nowhere"));
}

TEST_F(CommandTrajectory, OutKeepsARecordThatPageAndFiguresAreMadeOfAgain) {
  const fs::path out = folder_ / "study";
  const Outcome outcome = run("--align none --rpe 1m --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("report.html"));
  const auto study = nlohmann::json::parse(read(out / "trajectory.json"));
  ASSERT_EQ(study["runs"].size(), 1U);
  EXPECT_EQ(study["runs"][0]["sequence"], "truth");
  EXPECT_EQ(study["runs"][0]["run"], "estimate");
  EXPECT_EQ(study["runs"][0]["status"], "complete");
  EXPECT_NEAR(study["runs"][0]["ate"]["translation_m"]["rmse"], 0.01, 1e-8);
  EXPECT_EQ(study["provenance"]["options"]["--align"], "none");
  EXPECT_EQ(study["provenance"]["input"], "estimate.txt against truth.txt");
  const std::string again = (folder_ / "again").string();
  ASSERT_EQ(
      plumbline("report " + out.string() + " --out " + again + ".html --json " + again + ".json")
          .exit_code,
      0);
  EXPECT_EQ(read(again + ".html"), read(out / "report.html"));
  EXPECT_EQ(read(again + ".json"), read(out / "trajectory.json"));
  EXPECT_EQ(study["provenance"]["command"], "plumbline evaluate trajectory " + estimate().string() +
                                                " " + truth().string() +
                                                " --align none --rpe 1m --out " + out.string())
      << "as a shell takes it again";
}

TEST_F(CommandTrajectory, AnEstimateThatStartsLateIsPartialUnlessItsStartUpIsLeftOut) {
  std::string late = circle(100, 1);
  late.erase(0, late.find("101.500000000"));  // 30 of 100 poses
  write(folder_ / "estimate.txt", late);
  const std::string out = " --force --out " + (folder_ / "study").string();
  const auto statusOf = [&](const std::string& options) {
    EXPECT_EQ(run(options + out).exit_code, 0);
    return nlohmann::json::parse(read(folder_ / "study/trajectory.json"))["runs"][0];
  };
  const auto judged = statusOf("");
  EXPECT_EQ(judged["status"], "partial");
  EXPECT_NEAR(judged["coverage"], 3.45 / 4.95, 1e-9);
  EXPECT_NEAR(judged["starts_late_s"], 1.5, 1e-9);
  EXPECT_THAT(judged["problem"], HasSubstr("1.5 s after the truth's"));
  EXPECT_EQ(statusOf("--min-coverage 0.6")["status"], "complete");
  const auto from_first = statusOf("--coverage-from first-pose");
  EXPECT_EQ(from_first["status"], "complete");
  EXPECT_NEAR(from_first["coverage"], 1, 1e-9);
  expectRefusal(run("--coverage-from end"), 2, HasSubstr("first-pose"));
  // The verdict is the exit code where asked, and stands in the terminal with its cure.
  const Outcome failed = run("--fail-on caution");
  EXPECT_EQ(failed.exit_code, 4);
  EXPECT_THAT(failed.text, HasSubstr("--coverage-from first-pose"));
  EXPECT_EQ(run("--fail-on caution --json -").exit_code, 4);
  EXPECT_EQ(run("--fail-on bad").exit_code, 0);
  EXPECT_EQ(run("--fail-on caution --coverage-from first-pose").exit_code, 0);
}

// KITTI's poses have no stamps; an offset would pair frames with whatever the truth has there.
TEST_F(CommandTrajectory, AnEstimateWithoutStampsTakesThemFromAFile) {
  std::string poses, times;
  for (int i = 0; i < 100; ++i) {
    const double a = 0.05 * i, c = std::cos(a), s = std::sin(a);
    poses += fmt::format("{} {} 0 {} {} {} 0 {} 0 0 1 0\n", c, -s, c, s, c, s);
    times += fmt::format("{:.2f}\n", 1e9 + a);
  }
  write(estimate(), poses);
  write(folder_ / "times.txt", times);
  write(truth(), circle(1e9, 1));
  const Outcome without = run();
  expectRefusal(without, 1, AllOf(HasSubstr("has no stamps"), HasSubstr("--estimate-times")));
  EXPECT_THAT(without.text, Not(HasSubstr("--time-offset")));
  const Outcome with =
      run("--rpe none --json - --estimate-times " + (folder_ / "times.txt").string());
  ASSERT_EQ(with.exit_code, 0) << with.text;
  const auto ate = nlohmann::json::parse(with.text)["ate"]["translation_m"];
  EXPECT_EQ(ate["n"], 100);
  EXPECT_LT(ate["rmse"].get<double>(), 1e-5);
}

TEST_F(CommandTrajectory, VerdictsHaveColoursOnATerminalAndRecordsTheirFoldersName) {
  ASSERT_EQ(shell("command -v script").exit_code, 0) << "install bsdutils";
  const auto onTerminal = [&](const std::string& words) {
    return shell("env -u NO_COLOR script -qec '" + std::string(PLUMBLINE_BINARY) + " evaluate " +
                 words + "' /dev/null")
        .text;
  };
  const std::string out = (folder_ / "out").string();
  EXPECT_THAT(onTerminal("trajectories " + estimate().string() + " --truth " + truth().string() +
                         " --out " + out + "/"),
              HasSubstr("\033[32mVerdict: COMPLETE"));
  EXPECT_EQ(nlohmann::json::parse(read(out + "/trajectory.json"))["name"], "out");
  write(estimate(), circle(100, 50));
  EXPECT_THAT(onTerminal("trajectory " + estimate().string() + " " + truth().string()),
              HasSubstr("\033[33mVerdict: CAUTION"));
}

TEST_F(CommandTrajectory, HelpHasAnExample) {
  const Outcome outcome = plumbline("evaluate trajectory --help");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.text,
              AllOf(HasSubstr("Example"), HasSubstr("plumbline evaluate trajectory")));
  EXPECT_THAT(plumbline("evaluate --help").text, HasSubstr("trajectory"));
}

}  // namespace
}  // namespace plumbline
