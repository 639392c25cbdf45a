// SPDX-License-Identifier: BSD-3-Clause
// `plumbline simulate operator` as a user runs it: a recording that our commands read, with its
// suggestions and its truth.
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

fs::path emptyFolder(const char* name) {
  fs::path out =
      fs::path(::testing::TempDir()) / (std::string(name) + "_" + std::to_string(getpid()));
  fs::remove_all(out);
  return out;
}

TEST(CommandSimulateOperator, WritesARecordingThatOurCommandsRead) {
  const std::string options =
      "simulate operator --rig euroc --duration 10 --skill novice --compliance 1 --seed 4 ";
  const fs::path one = emptyFolder("operator_1"), two = emptyFolder("operator_2");
  const Outcome made = plumbline(options + "--judge --out " + one.string());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  EXPECT_THAT(made.text, HasSubstr("Simulated an operator (novice, guided, seed 4)"));
  EXPECT_THAT(made.text, HasSubstr("Cameras (0.1 px): "));
  EXPECT_THAT(made.text, HasSubstr("Run it: plumbline replay " + one.string() + " --target-shape " +
                                   one.string() + "/truth/target_shape.yaml --out replay;"));
  ASSERT_EQ(plumbline(options + "--judge --out " + two.string()).exit_code, 0);
  EXPECT_EQ(contents(one), contents(two)) << "same seed, same bytes";
  const auto truth = nlohmann::json::parse(read(one / "truth/truth.json"));
  EXPECT_EQ(truth.at("options").at("skill").at("compliance"), 1.0);
  EXPECT_NEAR(truth.at("options").at("skill").at("reaction_s"), 0.9, 1e-9);
  EXPECT_TRUE(truth.at("convergence").at("cameras").contains("at_end"));
  const fs::path out = emptyFolder("operator_replay");
  const Outcome replay = plumbline("replay " + one.string() +
                                   " --no-report --no-counterfactuals "
                                   "--out " +
                                   out.string());
  ASSERT_EQ(replay.exit_code, 0) << replay.text;
  // The replay follows the suggestions that were shown.
  const auto compliance = nlohmann::json::parse(read(out / "replay.json")).at("compliance");
  EXPECT_EQ(compliance.at("suggestions").size(), truth.at("suggestions").size());
  // What was measured is what was there: scored with the true cameras, noise remains.
  const fs::path scored = emptyFolder("operator_scored");
  const Outcome score =
      plumbline("evaluate calibration " + (one / "truth/camchain-imucam.yaml").string() + " " +
                one.string() + " --target-shape " + (one / "truth/target_shape.yaml").string() +
                " --no-report --out " + scored.string());
  EXPECT_EQ(score.exit_code, 0) << score.text;
  for (const auto& folder : {one, two, out, scored}) fs::remove_all(folder);
}

TEST(CommandSimulateOperator, JudgesTheStopsOfBothStages) {
  const fs::path out = emptyFolder("operator_stops");
  const Outcome made = plumbline(
      "simulate operator --rig euroc --duration 40 --stop-projection-px 0.1 "
      "--stop-reprojection-px 0.5 --judge --out " +
      out.string());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  EXPECT_THAT(made.text, HasSubstr("Camera stage: stopped after "));
  EXPECT_THAT(made.text, HasSubstr("Camera-IMU stage: stopped after "));
  const auto truth = nlohmann::json::parse(read(out / "truth/truth.json"));
  for (const auto& [stage, bar_px] : {std::pair("cameras", 0.1), std::pair("camera_imu", 0.5)}) {
    const auto& stop = truth.at("stop").at(stage);
    EXPECT_NEAR(stop.at("stopped_s").get<double>(),
                truth.at("convergence").at(stage).at("stopped_s").get<double>(), 1e-9)
        << stage;
    EXPECT_LE(stop.at("predicted_px").get<double>(), bar_px);
    EXPECT_NEAR(stop.at("expected_px").get<double>(), bar_px, 0.2 * bar_px) << stage;
    EXPECT_TRUE(stop.at("best_s").is_number()) << stage;
  }
  const auto& end = truth.at("convergence").at("camera_imu").at("at_end");
  EXPECT_TRUE(end.at("reprojection_px").is_number());
  fs::remove_all(out);
}

TEST(CommandSimulateOperator, RecordsWithoutAGuideToo) {
  const fs::path out = emptyFolder("operator_dance");
  const Outcome made =
      plumbline("simulate operator --method dance --duration 6 --skill 0.3 --out " + out.string());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  EXPECT_FALSE(fs::exists(out / "suggestions.csv"));
  const auto truth = nlohmann::json::parse(read(out / "truth/truth.json"));
  EXPECT_EQ(truth.at("options").at("skill").at("own_views"), "dance");
  EXPECT_EQ(truth.at("finished"), true);
  fs::remove_all(out);
}

// Time was up before the guide came to the IMU; and a board that is not bent is the one stated.
TEST(CommandSimulateOperator, AStageThatWasNotRecordedIsNotCalledInaccurate) {
  const fs::path out = emptyFolder("operator_short");
  const Outcome made = plumbline(
      "simulate operator --rig euroc --duration 5 --skill novice --board-bend-mm 0 --judge --out " +
      out.string());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  EXPECT_THAT(made.text, HasSubstr("0.0 s for the IMU"));
  EXPECT_THAT(made.text, HasSubstr("T_SC0 (1 mm, 0.05 deg): not recorded\n"));
  EXPECT_FALSE(fs::exists(out / "truth/target_shape.yaml"));
  EXPECT_THAT(made.text, HasSubstr("Run it: plumbline replay " + out.string() + " --out replay;"));
  const auto truth = nlohmann::json::parse(read(out / "truth/truth.json"));
  EXPECT_EQ(truth.at("board").at("terms").at("stretch"), 0.0);
  fs::remove_all(out);
}

// Suggestions by gain per second say how long each will take; the replay's log says how long it
// took, and what the stop was held against.
TEST(CommandSimulateOperator, PredictsTheWayToItsSuggestions) {
  const fs::path session = emptyFolder("operator_pace"), out = emptyFolder("operator_pace_out");
  const std::string guide = " --operator-speed 0.35 --stop-projection-px 0.1 ";
  const Outcome made =
      plumbline("simulate operator --rig euroc --duration 10 --skill expert --seed 5" + guide +
                "--out " + session.string());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  EXPECT_THAT(made.text, HasSubstr("target_shape.yaml --stop-projection-px 0.1 --operator-speed "
                                   "0.35 --out replay;"));
  const auto truth = nlohmann::json::parse(read(session / "truth/truth.json"));
  ASSERT_FALSE(truth.at("suggestions").empty());
  for (const auto& s : truth.at("suggestions")) {
    const double held_s = s.at("stage") == "camera" ? 0.3 : 0;  // the first trajectory is not held
    EXPECT_GE(s.at("reach_s").get<double>(), 0.5 + held_s - 1e-9) << "reaction and hold at least";
  }
  const Outcome replay = plumbline("replay " + session.string() + " --target-shape " +
                                   (session / "truth/target_shape.yaml").string() + guide +
                                   "--no-counterfactuals --out " + out.string());
  ASSERT_EQ(replay.exit_code, 0) << replay.text;
  const auto log = read(out / "decisions.jsonl");
  EXPECT_THAT(log, HasSubstr("\"projection_px\":0."));
  EXPECT_THAT(log, HasSubstr("\"reach_s\":"));
  const std::string page = read(out / "report.html");
  EXPECT_THAT(page, HasSubstr("Predicted time [s]"));
  EXPECT_THAT(page, HasSubstr("predicted projection error 0."));
  fs::remove_all(session), fs::remove_all(out);
}

// They would change nothing, and whoever gives them expects that they do.
TEST(CommandSimulateOperator, RefusesOptionsOfTheGuideWithoutOne) {
  const std::string out = emptyFolder("operator_unguided").string();
  for (const std::string method : {"free", "dance"}) {
    for (const std::string option :
         {"--trajectories 2", "--criterion mi", "--stop-projection-px 0.1",
          "--stop-reprojection-px 0.2", "--trajectory-s 2", "--trajectory-amplitude 1",
          "--trajectory-roll 30", "--trajectory-held-s 1", "--first-trajectory scored",
          "--operator-speed 0.3", "--reached-px 15", "--reached-s 0.5"}) {
      const Outcome refused =
          plumbline("simulate operator --method " + method + " " + option + " --out " + out);
      EXPECT_EQ(refused.exit_code, 2) << option;
      EXPECT_THAT(refused.text, HasSubstr("plumbline: " + option.substr(0, option.find(' ')) +
                                          " is of the guide, which --method " + method));
      EXPECT_FALSE(fs::exists(out)) << option;
    }
  }
}

TEST(CommandSimulateOperator, NamesASkillOutOfItsRange) {
  for (const std::string bad :
       {"--skill 1.5", "--skill clumsy", "--compliance 2", "--overshoot -0.1", "--method slow"}) {
    const Outcome refused = plumbline("simulate operator " + bad + " --out nowhere");
    EXPECT_EQ(refused.exit_code, 2) << bad;
    EXPECT_THAT(refused.text, HasSubstr(bad.substr(2, bad.find(' ') - 2))) << bad;
  }
}

TEST(CommandSimulateOperator, NamesTheOptionAndTheValueAsItWasWritten) {
  const auto expect = [](const std::string& option, const std::vector<std::string>& ends,
                         const std::vector<std::string>& outside) {
    expectRange("simulate operator", option, ends, outside);
  };
  expect("--reaction-s", {"0", "10"}, {"-0.1", "nan"});
  expect("--speed", {"0.001", "10"}, {"0", "11"});
  expect("--turn", {"0.0572958", "572.957"}, {"0.0572", "572.96"});
  expect("--position-error-mm", {"0", "1000"}, {"-1", "1001"});
  expect("--angle-error", {"0", "57.2957"}, {"-1", "57.3"});
  expect("--correction-s", {"0.001", "100"}, {"0", "101"});
  expect("--overshoot", {"0", "1"}, {"-0.1", "1.1"});
  expect("--tremor-mm", {"0", "100"}, {"-1", "101"});
  expect("--tremor", {"0", "5.72957"}, {"-1", "5.73"});
  expect("--off-axis", {"1.14592", "180"}, {"1.14", "180.001"});
  expect("--fatigue", {"0", "10"}, {"-1", "11"});
  expect("--compliance", {"0", "1"}, {"-1", "2"});
  expect("--patience-s", {"0", "100000"}, {"-1", "1000000"});
  expect("--trajectory-roll", {"0", "180"}, {"-1", "181"});
  expect("--duration", {"5", "3600"}, {"4", "nan"});
  expect("--corner-sigma", {"0", "100"}, {"-1", "nan"});
  expect("--board-bend-mm", {"0", "20"}, {"-1", "nan"});
}

}  // namespace
}  // namespace plumbline
