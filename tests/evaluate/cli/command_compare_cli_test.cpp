// SPDX-License-Identifier: BSD-3-Clause
// plumbline compare as a user runs it: on a simulated recording whose calibration is written in our
// format and in Kalibr's, and what it refuses.
#include <cmath>
#include <regex>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class CommandCompare : public CommandLine {
 protected:
  static void SetUpTestSuite() {
    CommandLine::SetUpTestSuite();
    const Outcome outcome = plumbline("calibrate " + session().string() + " --out " +
                                      (root_ / "result").string() + " --no-cache --no-report");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  static std::string ours() { return (root_ / "result/calibration.json").string(); }
  static std::string kalibrs() { return (root_ / "result/camchain-imucam.yaml").string(); }
  static std::string truth() { return (session() / "truth/camchain-imucam.yaml").string(); }

  Outcome compare(const std::string& arguments) const {
    return plumbline("compare --force " + arguments + " --out " + (scratch() / "out").string() +
                     " --no-cache --no-report");
  }
  json document() const { return json::parse(read(scratch() / "out/comparison.json")); }
  static json row(const json& document, const std::string& name) {
    for (const json& p : document["parameters"]) {
      if (p["name"] == name) return p;
    }
    ADD_FAILURE() << name;
    return {};
  }
};

// truth.json is written with the field list that calibration.json is read by.
TEST_F(CommandCompare, TakesTheTruthOfASimulation) {
  const Outcome outcome = compare(ours() + " " + (session() / "truth/truth.json").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json parameters = document();
  const json offset = row(parameters, "time_offset");
  EXPECT_LT(std::abs(offset["difference"][1].get<double>()), 1e-4);
  const json focal = row(parameters, "cam0.fu");
  EXPECT_LT(std::abs(focal["difference"][1].get<double>()), 1);
  EXPECT_TRUE(parameters["calibrations"][1]["imu"]["noise"]["gyroscope_noise_density"].is_number());
}

TEST_F(CommandCompare, TheSameCalibrationInTwoFormatsIsIdentical) {
  const Outcome outcome = compare(ours() + " " + kalibrs());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json d = document();
  EXPECT_EQ(d["parameters"].size(), 33u);  // 2 x 8 + 6 + 6 + 1, 2 x (angle, lever)
  for (const json& p : d["parameters"]) {
    ASSERT_TRUE(p["difference"][1].is_number()) << p["name"];
    EXPECT_LT(std::abs(p["difference"][1].get<double>()), 1e-9) << p["name"];
  }
  ASSERT_EQ(d["differences"].size(), 4u);  // 2 cameras, 2 ranges
  for (const json& map : d["differences"]) {
    for (const json& v : map["values_px"]) EXPECT_LT(v.get<double>(), 1e-6);
  }
  // Ours carries a covariance, Kalibr's does not; without a recording nobody is scored.
  EXPECT_EQ(d["uncertainties"].size(), 4u);
  EXPECT_THAT(d["uncertainties"][0]["method"], HasSubstr("image fit"));
  EXPECT_TRUE(d["scores"].empty());
  EXPECT_THAT(outcome.text, HasSubstr("cam0.fu [px]"));
  EXPECT_THAT(read(scratch() / "out/comparison.csv"), HasSubstr("T_SC0.angle,rad,"));
}

// A circle of 1 m in the x-y plane, its radius off by `error_m`, as a TUM file.
std::string circle(double error_m) {
  std::string text;
  for (int i = 0; i < 200; ++i) {
    const double a = 0.06 * i;
    const double r = 1 + error_m * (i % 2 == 0 ? 1 : -1);
    text += std::to_string(100 + 0.05 * i) + " " + std::to_string(r * std::cos(a)) + " " +
            std::to_string(r * std::sin(a)) + " " + std::to_string(0.2 * std::sin(3 * a)) +
            " 0 0 0 1\n";
  }
  return text;
}

TEST_F(CommandCompare, TrajectoriesUnderTheCalibrationsJoinThePage) {
  fs::create_directories(scratch());
  write(scratch() / "truth.txt", circle(0));
  write(scratch() / "ours_loop_1.txt", circle(0.01));
  write(scratch() / "kalibr_loop_1.txt", circle(0.03));
  const std::string pattern = (scratch() / "{calibration}_{sequence}_{run}.txt").string();
  const Outcome outcome = plumbline("compare " + ours() + " " + kalibrs() +
                                    " --labels ours,kalibr --grid 5x3 --focus-radius 300 --runs '" +
                                    pattern + "' --truth " + (scratch() / "truth.txt").string() +
                                    " --out " + (scratch() / "out").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string page = read(scratch() / "out/report.html");
  EXPECT_THAT(page, HasSubstr("Paired differences"));
  EXPECT_THAT(page, HasSubstr("loop"));
  EXPECT_THAT(outcome.text, HasSubstr("ours - kalibr: ATE -0.0200 m"));
  const std::string table = read(scratch() / "out/comparison.csv");
  std::smatch all;
  ASSERT_TRUE(
      std::regex_search(table, all, std::regex("ate\\.loop,m,([^,]+),([^,]+),,,,([^,]+),,")))
      << table;
  EXPECT_NEAR(std::stod(all[1]), 0.01, 1e-4);
  EXPECT_NEAR(std::stod(all[2]), 0.03, 1e-4);
  EXPECT_NEAR(std::stod(all[3]), 0.02, 1e-4);  // kalibr - ours
}

TEST_F(CommandCompare, RunsThatFailedAreNoGoodVerdict) {
  fs::create_directories(scratch());
  write(scratch() / "truth.txt", circle(0));
  write(scratch() / "ours_loop_1.txt", circle(0.01));
  write(scratch() / "kalibr_loop_1.txt", circle(0.03));
  const auto compared = [&](const std::string& how) {
    return compare(ours() + " " + kalibrs() +
                   " --labels ours,kalibr --grid 5x3 --focus-radius 300" + " --runs '" +
                   (scratch() / "{calibration}_{sequence}_{run}.txt").string() + "' --truth " +
                   (scratch() / "truth.txt").string() + " --fail-on bad" + how);
  };
  // As evaluate trajectories aligns and reads them, when asked to.
  EXPECT_EQ(compared(" --align sim3 --truth-inverted").exit_code, 0);
  EXPECT_THAT(document()["trajectories"].dump(), HasSubstr("sim3"));
  EXPECT_EQ(compared("").exit_code, 0);
  write(scratch() / "kalibr_loop_1.txt", "");
  const Outcome failed = compared("");
  EXPECT_EQ(failed.exit_code, 4) << failed.text;
  EXPECT_THAT(failed.text, HasSubstr("Complete runs of kalibr: 0 of 1 complete"));
  EXPECT_EQ(document()["verdict"]["level"], "bad");
  EXPECT_THAT(document()["verdict"]["headline"], HasSubstr("of ours 0.01 m"));
}

TEST_F(CommandCompare, RunsOfACalibrationThatIsNotComparedAreRefusedWithTheLabels) {
  fs::create_directories(scratch());
  write(scratch() / "truth.txt", circle(0));
  write(scratch() / "ours_loop_1.txt", circle(0.01));
  write(scratch() / "other_loop_1.txt", circle(0.03));
  const std::string truth = " --truth " + (scratch() / "truth.txt").string();
  const std::string both = ours() + " " + kalibrs() + " --labels ours,kalibr";
  const std::string pattern = (scratch() / "{calibration}_{sequence}_{run}.txt").string();
  expectRefusal(compare(both + " --runs '" + pattern + "'" + truth), 2,
                AllOf(HasSubstr("other_loop_1.txt"), HasSubstr("ours, kalibr")));
  const std::string without = (scratch() / "ours_{sequence}_{run}.txt").string();
  expectRefusal(compare(both + " --runs '" + without + "'" + truth), 2, HasSubstr("{calibration}"));
}

TEST_F(CommandCompare, RunsAndTruthBelongTogether) {
  const std::string both = ours() + " " + kalibrs();
  expectRefusal(compare(both + " --runs x"), 2, HasSubstr("--runs requires --truth"));
  expectRefusal(compare(both + " --truth x"), 2, HasSubstr("--truth requires --runs"));
  expectRefusal(compare(both + " --runs '' --truth ''"), 2, HasSubstr("--runs"));
  const std::string help = plumbline("compare --help").text;
  EXPECT_THAT(help, AllOf(HasSubstr("--runs TEXT Needs: --truth"),
                          HasSubstr("--truth TEXT Needs: --runs")));
  for (const char* of_runs :
       {"--min-coverage 0.5", "--coverage-from first-pose", "--max-ate 1", "--hand-eye auto"}) {
    const Outcome without = compare(ours() + " " + kalibrs() + " " + of_runs);
    EXPECT_EQ(without.exit_code, 2) << of_runs;
    EXPECT_THAT(without.text, HasSubstr("--runs")) << of_runs;
  }
}

TEST_F(CommandCompare, WithARecordingBothAreScored) {
  const Outcome outcome = compare(ours() + " " + truth() + " --labels ours,truth --session " +
                                  session().string() + " --range inf --grid 5x3");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json d = document();
  ASSERT_EQ(d["scores"].size(), 2u);
  // Corners have 0.2 px an axis: 0.28 px, under the estimate in sample and under the truth.
  for (const json& score : d["scores"]) {
    EXPECT_NEAR(score["reprojection"]["rmse_px"].get<double>(), 0.28, 0.02);
    EXPECT_EQ(score["entropy_parameters"].size(), 22u);
  }
  // The same corners, noise and list at nearly the same values.
  EXPECT_NEAR(d["scores"][0]["entropy_nats"].get<double>(),
              d["scores"][1]["entropy_nats"].get<double>(), 0.1);
  // The session itself gives what `calibrate` made of it, and the truth is within its deviations.
  const json& own = d["session_estimate"];
  ASSERT_FALSE(own.contains("problem")) << own["problem"];
  for (const json& p : own["parameters"]) {
    ASSERT_EQ(p["values"].size(), 3u);
    if (p["std"][0].is_null()) continue;
    EXPECT_NEAR(p["difference"][1].get<double>(), 0, 1e-6 * p["std"][0].get<double>()) << p["name"];
    EXPECT_LT(std::abs(p["difference"][2].get<double>()), 4 * p["std"][0].get<double>())
        << p["name"];
  }
  ASSERT_EQ(d["paired"].size(), 2u);
  EXPECT_GT(d["paired"][0]["difference_px2"].get<double>(), 0);  // in sample, ours fits the noise
  EXPECT_EQ(d["uncertainties"].size(), 4u);
  EXPECT_EQ(d["uncertainties"][0]["values_px"].size(), 15u);
  EXPECT_THAT(d["uncertainties"][0]["method"], HasSubstr("cross-reprojection on "));
  // The truth is as far away as the predicted deviations allow: 0.2 px of a sigma of 1.
  for (const json& map : d["differences"]) {
    for (std::size_t i = 0; i < 15; ++i) {
      const double std = d["uncertainties"][map["camera"] == "cam0" ? 0 : 1]["values_px"][i];
      EXPECT_LT(map["values_px"][i].get<double>(), 5 * 0.2 * std) << map["camera"] << i;
    }
  }
}

// A bent board, and a calibration that takes it as flat: they differ by the board, unless the
// session's own estimate is told to take it as flat, too.
TEST_F(CommandCompare, TheSessionsOwnEstimateTakesTheBoardAsSaid) {
  fs::create_directories(scratch());
  const std::string bent = (scratch() / "bent").string();
  const std::string common = " --only cam0 --loss none --no-cache --no-report --out ";
  ASSERT_EQ(
      plumbline("simulate --seed 3 --duration 8 --camera-rate 5 --target-shape bow=4mm --out " +
                bent)
          .exit_code,
      0);
  ASSERT_EQ(plumbline("calibrate " + bent +
                      " --no-imu --no-halves --models pinhole-radtan --target-shape flat" + common +
                      (scratch() / "flat").string())
                .exit_code,
            0);
  const std::string flat = (scratch() / "flat/camchain.yaml").string();
  const auto findings = [&] { return document()["verdict"]["findings"].dump(); };
  const auto difference = [&](const std::string& options) {
    const Outcome outcome = plumbline("compare --force " + flat + " " + flat +
                                      " --labels a,b --range inf --grid 5x3 --session " + bent +
                                      options + common + (scratch() / "out").string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return std::abs(document()["session_estimate"]["parameters"][0]["difference"][1].get<double>());
  };
  EXPECT_GT(difference(""), 1);  // cam0.fu [px]
  EXPECT_LT(difference(" --target-shape flat"), 0.05);
  EXPECT_THAT(findings(), Not(HasSubstr("Shape of the target")));
  // A shape that a calibration came with is not used unasked, which is said where the flat board
  // is.
  fs::copy_file(fs::path(bent) / "truth/target_shape.yaml", scratch() / "flat/target_shape.yaml");
  difference("");
  EXPECT_THAT(findings(),
              AllOf(HasSubstr("Board of the recording"), Not(HasSubstr("a: Shape of the target"))));
  const Outcome unasked = plumbline("compare --force " + flat + " " + flat +
                                    " --labels a,b --range inf --grid 5x3 --no-session-estimate "
                                    "--session " +
                                    bent + common + (scratch() / "out").string());
  EXPECT_EQ(unasked.exit_code, 0) << unasked.text;
  EXPECT_THAT(findings(), HasSubstr("a: Shape of the target"));
  difference(" --target-shape " + (scratch() / "flat/target_shape.yaml").string());
  EXPECT_THAT(findings(), Not(HasSubstr("Shape of the target")));
}

// On the flat board cameras that took the bent one as flat would fit its corners best.
TEST_F(CommandCompare, OnABentBoardTheCalibrationThatKnewItIsBetter) {
  fs::create_directories(scratch());
  const auto recorded = [&](const char* name, int seed) {
    const std::string folder = (scratch() / name).string();
    const Outcome outcome =
        plumbline("simulate --seed " + std::to_string(seed) +
                  " --duration 12 --camera-rate 5 --target-shape bow=2mm --out " + folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return folder;
  };
  const std::string first = recorded("first", 81), other = recorded("other", 82);
  const auto calibrated = [&](const std::string& shape) {
    const std::string out = (scratch() / shape).string();
    EXPECT_EQ(plumbline("calibrate " + first +
                        " --no-imu --no-halves --models pinhole-radtan --no-cache --no-report "
                        "--target-shape " +
                        shape + " --out " + out)
                  .exit_code,
              0);
    return out + "/calibration.json";
  };
  const Outcome outcome = compare(calibrated("auto") + " " + calibrated("flat") +
                                  " --labels known,flat --range inf --grid 5x3 --session " + other);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("known predicts held-out corners better"));
}

// 4 mm of a lever arm hardly show in pixels; estimated on the recording they do.
TEST_F(CommandCompare, ALeverArmThatIsNotTheRecordingsIsSaid) {
  json moved = json::parse(read(ours()));
  moved["imu"]["T_SC0"][0][3] = moved["imu"]["T_SC0"][0][3].get<double>() + 0.004;
  fs::create_directories(scratch());
  write(scratch() / "moved.json", moved.dump());
  const Outcome outcome =
      compare(ours() + " " + (scratch() / "moved.json").string() +
              " --labels ours,moved --range inf --grid 5x3 --session " + session().string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json verdict = document()["verdict"];
  EXPECT_NE(verdict["level"], "good");
  int of_ours = 0;
  for (const json& f : verdict["findings"]) {
    if (f["rule"] == "moved: T_SC0 and time offset against this recording") {
      EXPECT_EQ(f["level"], "caution") << f;
    }
    if (f["rule"] == "ours: T_SC0 and time offset against this recording") {
      EXPECT_EQ(f["level"], "good") << f;
      ++of_ours;
    }
  }
  EXPECT_EQ(of_ours, 1);
  EXPECT_THAT(outcome.text, HasSubstr("moved: T_SC0 and time offset against this recording"));
  // What the tests say decides the advice on where the two differ.
  EXPECT_EQ(document()["calibrations"][0]["contradicted"], false);
  EXPECT_EQ(document()["calibrations"][1]["contradicted"], true);
  for (const json& f : verdict["findings"]) {
    if (f["rule"] == "Transforms and offset of moved against ours" && f["level"] != "good") {
      EXPECT_THAT(std::string(f["advice"]), HasSubstr("contradicts moved alone")) << f;
    }
  }
}

TEST_F(CommandCompare, TheSessionItselfCanBeLeftOut) {
  ASSERT_EQ(compare(ours() + " " + truth() +
                    " --labels ours,truth --range inf --grid 5x3 "
                    "--no-session-estimate --session " +
                    session().string())
                .exit_code,
            0);
  EXPECT_FALSE(document().contains("session_estimate") &&
               !document()["session_estimate"].is_null());
}

// Under other options the input hash is another one, and the recording the same.
TEST_F(CommandCompare, OnlyAnotherRecordingIsHeldOut) {
  json other = json::parse(read(ours()));
  other["provenance"]["input_hash"] = "xxh64:0123456789abcdef";
  other["provenance"]["camera_hashes"] = {"xxh64:0123456789abcdef"};
  fs::create_directories(scratch());
  write(scratch() / "options.json", other.dump());
  other["provenance"]["input"] = "another";
  write(scratch() / "recording.json", other.dump());
  const Outcome outcome =
      compare(ours() + " " + (scratch() / "options.json").string() + " " +
              (scratch() / "recording.json").string() +
              " --range inf --grid 5x3 --no-session-estimate --session " + session().string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json scores = document()["scores"];
  EXPECT_EQ(scores[0]["held_out"], false);
  EXPECT_EQ(scores[1]["held_out"], false);
  EXPECT_EQ(scores[2]["held_out"], true);
}

// evaluate calls it bad, by the same thresholds.
TEST_F(CommandCompare, ACalibrationThatMissesTheCornersIsBad) {
  json longer = json::parse(read(ours()));
  json& baseline = longer["cameras"][1]["T_C0Ci"][0][3];
  baseline = 1.1 * baseline.get<double>();
  fs::create_directories(scratch());
  write(scratch() / "longer.json", longer.dump());
  const std::string file = (scratch() / "longer.json").string();
  const Outcome outcome = compare(file + " " + file +
                                  " --labels a,b --range inf --grid 5x3 --no-session-estimate "
                                  "--session " +
                                  session().string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_GT(document()["scores"][0]["reprojection"]["rmse_px"].get<double>(), 2);
  EXPECT_EQ(document()["verdict"]["level"], "bad");
  EXPECT_THAT(outcome.text, HasSubstr("a: Reprojection error of cam"));
}

TEST_F(CommandCompare, ATimeShiftThatIsNotStatedIsUnknown) {
  fs::create_directories(scratch());
  write(scratch() / "untimed.yaml",
        std::regex_replace(read(kalibrs()), std::regex("  timeshift_cam_imu:[^\n]*\n"), ""));
  const Outcome outcome =
      plumbline("compare " + ours() + " " + (scratch() / "untimed.yaml").string() +
                " --grid 5x3 --focus-radius 300 --out " + (scratch() / "out").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json offset = row(document(), "time_offset");
  EXPECT_TRUE(offset["values"][0].is_number());
  EXPECT_TRUE(offset["values"][1].is_null());
  EXPECT_TRUE(offset["difference"][1].is_null());
  EXPECT_TRUE(document()["offsets"][1]["time_offset_s"].is_null());
  EXPECT_TRUE(document()["calibrations"][1]["imu"]["time_offset_s"].is_null());
  EXPECT_EQ(outcome.text.find("in the time offset"), std::string::npos) << outcome.text;
}

TEST_F(CommandCompare, RefusesWhatItCannotCompare) {
  const auto refused = [this](const std::string& arguments, const std::string& words) {
    expectRefusal(compare(arguments), 2, HasSubstr(words));
  };
  const std::string both = ours() + " " + kalibrs();
  refused(ours(), "two or more");
  refused(both + " --range 0", "--range 0");
  refused(both + " --range 1m", "--range 1m");
  refused(both + " --grid 2x2", "2x2");
  refused(both + " --labels a", "1 labels for 2");
  refused(both + " --labels a,a", "--labels: a is given twice");
  refused(both + " --labels a,,b", "--labels 'a,,b': has an empty entry");
  refused(both + " --range 1,1.0", "--range: 1 is given twice");
  refused(both + " --fit best", "squares or fourth-power");
  refused(both + " --uncertainty none", "cross-reprojection or mean-frames");
  refused(both + " --focus-radius -1", "--focus-radius");
  refused(both + " --focus-radius 20", "larger --focus-radius");
  refused(both + " --grid 5x3", "finer --grid");
  refused(both + " --from 3", "--session");
  refused(both + " --target target.yaml", "--session");
  refused(both + " --session " + (scratch() / "nowhere").string(), "nowhere");
  refused(ours() + " " + (session() / "target.yaml").string(), "target.yaml");
}

}  // namespace
}  // namespace plumbline
