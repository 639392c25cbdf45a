// SPDX-License-Identifier: BSD-3-Clause
// plumbline evaluate calibration, as a user runs it.
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class EvaluateCalibration : public CommandLine {
 protected:
  static void SetUpTestSuite() {
    CommandLine::SetUpTestSuite();
    const Outcome outcome =
        plumbline("calibrate " + session().string() + " --out " + (root_ / "own").string() +
                  " --models pinhole-radtan --no-halves --no-cache --no-report");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  static std::string ours() { return (root_ / "own" / "calibration.json").string(); }

  Outcome score(const std::string& calibration, const fs::path& folder,
                const std::string& options = "") const {
    return plumbline("evaluate calibration --force " + calibration + " " + folder.string() +
                     " --out " + (scratch() / "out").string() + " --no-cache " + options);
  }
  nlohmann::json document() const {
    return nlohmann::json::parse(read(scratch() / "out" / "evaluation.json"));
  }
};

TEST_F(EvaluateCalibration, OursAndItsKalibrFormScoreAlikeAsTheirOwnResult) {
  const auto own = nlohmann::json::parse(read(ours())).at("stages");
  const Outcome outcome = score(ours(), session());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("cam0"), HasSubstr("with IMU")));
  const auto s = document().at("scores").at(0);
  EXPECT_NEAR(s.at("reprojection").at("rmse_px").get<double>(),
              own.at("camera").at("rmse_px").get<double>(), 1e-6);
  EXPECT_NEAR(s.at("camera_imu").at("rmse_px").get<double>(),
              own.at("camera_imu").at("rmse_px").get<double>(), 1e-5);
  EXPECT_NEAR(s.at("camera_imu_cost").get<double>(), own.at("camera_imu").at("cost").get<double>(),
              1e-5 * own.at("camera_imu").at("cost").get<double>());
  EXPECT_EQ(s.at("held_out"), false);
  const Outcome kalibr = score((root_ / "own" / "camchain-imucam.yaml").string(), session());
  ASSERT_EQ(kalibr.exit_code, 0) << kalibr.text;
  const auto k = document().at("scores").at(0);
  EXPECT_NEAR(k.at("camera_imu").at("rmse_px").get<double>(),
              s.at("camera_imu").at("rmse_px").get<double>(), 1e-6);
}

// Poses absorb most of a focal length that is wrong: the RMSE stays below a tenth of the bound.
TEST_F(EvaluateCalibration, CamerasOtherThanTheCornersAskForAreACaution) {
  const auto against = [&] {
    const nlohmann::json found = document();
    for (const auto& f : found.at("verdict").at("findings")) {
      if (f.at("rule") == "Cameras against this recording") return f;
    }
    return nlohmann::json();
  };
  ASSERT_EQ(score(ours(), session(), "--no-imu").exit_code, 0);
  EXPECT_EQ(against().at("level"), "good");
  EXPECT_LT(against().at("value").get<double>(), 0.1);
  std::string chain = read(root_ / "own" / "camchain-imucam.yaml");
  std::size_t at = chain.find("intrinsics: [") + 13;
  for (int k = 0; k < 2; ++k) {
    const std::size_t end = chain.find(',', at);
    const std::string focal = fmt::format("{:.6f}", 1.01 * std::stod(chain.substr(at, end - at)));
    chain.replace(at, end - at, focal);
    at += focal.size() + 2;
  }
  fs::create_directories(scratch());
  write(scratch() / "camchain.yaml", chain);
  const Outcome outcome = score((scratch() / "camchain.yaml").string(), session(), "--no-imu");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(against().at("level"), "caution");
  EXPECT_EQ(against().at("subject"), "cameras");
  // 1 % of the image's radius is two to three pixels, each 0.5 px one bound.
  EXPECT_GT(against().at("value").get<double>(), 3);
  EXPECT_LT(against().at("value").get<double>(), 8);
  EXPECT_EQ(document().at("verdict").at("level"), "caution");
}

// They explain all else that the recording says of the file, and lead the verdict.
TEST_F(EvaluateCalibration, MistakesOfUnitsAndConventionsComeFirst) {
  const auto firstOf = [&](const nlohmann::json& calibration) {
    fs::create_directories(scratch());
    write(scratch() / "edited.json", calibration.dump());
    const Outcome outcome = score((scratch() / "edited.json").string(), session(), "--no-report");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    const nlohmann::json verdict = document().at("verdict");
    EXPECT_EQ(verdict.at("level"), "bad");
    return verdict.at("findings").at(0).at("rule").get<std::string>();
  };
  const auto own = nlohmann::json::parse(read(ours()));
  nlohmann::json late = own;
  late["imu"]["time_offset_s"] = own["imu"]["time_offset_s"].get<double>() + 0.02;
  EXPECT_EQ(firstOf(late), "Contradicting time offset");
  nlohmann::json inverted = own;
  const auto T = own["imu"]["T_SC0"];
  for (int i = 0; i < 3; ++i) {
    double t = 0;
    for (int k = 0; k < 3; ++k) {
      inverted["imu"]["T_SC0"][i][k] = T[k][i];
      t -= T[k][i].get<double>() * T[k][3].get<double>();
    }
    inverted["imu"]["T_SC0"][i][3] = t;
  }
  EXPECT_EQ(firstOf(inverted), "Inverted transform");
}

// No frame has a pose under a baseline of 110 m: the cause is in the message.
TEST_F(EvaluateCalibration, MillimetresAreNamedWhereNothingCanBeScored) {
  nlohmann::json calibration = nlohmann::json::parse(read(ours()));
  for (int k = 0; k < 3; ++k) {
    auto& t = calibration["cameras"][1]["T_C0Ci"][k][3];
    t = 1000 * t.get<double>();
  }
  fs::create_directories(scratch());
  write(scratch() / "mm.json", calibration.dump());
  const Outcome outcome = score((scratch() / "mm.json").string(), session());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("in millimetres it would be 0.11"));
}

TEST_F(EvaluateCalibration, FoldsAndHeldOutSessionsAreScoredBesideIt) {
  const fs::path other = scratch() / "other";
  fs::create_directories(scratch());
  ASSERT_EQ(plumbline("simulate --out " + other.string() + " --rig euroc --seed 9 --duration 6")
                .exit_code,
            0);
  const Outcome outcome =
      score(ours(), session(), "--no-imu --folds 2 --held-out " + other.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const auto scores = document().at("scores");
  ASSERT_EQ(scores.size(), 8u);
  EXPECT_EQ(scores.at(6).at("part"), "all 2 folds");
  EXPECT_EQ(scores.at(6).at("held_out"), true);
  EXPECT_EQ(scores.at(7).at("session"), "other");
  EXPECT_EQ(scores.at(7).at("held_out"), true);
  EXPECT_GT(scores.at(7).at("per_camera").at("cam1").at("corners").get<int>(), 1000);
  EXPECT_FALSE(scores.at(0).contains("camera_imu"));
  EXPECT_THAT(outcome.text, HasSubstr("other, held out"));
  // The held-out recording is an input like the first, and refused like it.
  const auto hash = document().at("provenance").at("input_hash");
  std::string target = read(other / "target.yaml");
  write(other / "target.yaml", target + "# another content\n");
  ASSERT_EQ(score(ours(), session(), "--no-imu --held-out " + other.string()).exit_code, 0);
  EXPECT_NE(document().at("provenance").at("input_hash"), hash);
  const auto at = target.find("tagSpacing: ") + 12;
  target.replace(at, target.find('\n', at) - at, "0.6");
  write(other / "target.yaml", target);
  const Outcome refused = score(ours(), session(), "--no-imu --held-out " + other.string());
  EXPECT_EQ(refused.exit_code, 2) << refused.text;
  EXPECT_THAT(refused.text, HasSubstr("tagSpacing"));
}

TEST_F(EvaluateCalibration, AHeldOutFolderMayHaveACommaInItsName) {
  const fs::path other = scratch() / "a,b";
  fs::create_directories(scratch());
  ASSERT_EQ(plumbline("simulate --out " + other.string() + " --seed 9 --duration 6").exit_code, 0);
  const std::string held_out = " --no-report --held-out " + other.string();
  ASSERT_EQ(score(ours(), session(), "--no-imu" + held_out).exit_code, 0);
  EXPECT_EQ(document().at("scores").at(1).at("session"), "a,b");
  const Outcome twice =
      score(ours(), session(), "--no-imu" + held_out + " --held-out " + other.string());
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.text, HasSubstr("a,b is given twice"));
}

// The file states what it was estimated from, whatever the user says of a recording.
TEST_F(EvaluateCalibration, HeldOutIsWhatTheFilesDoNotContradict) {
  const fs::path other = scratch() / "other", copy = scratch() / "copy";
  fs::create_directories(scratch());
  ASSERT_EQ(plumbline("simulate --out " + other.string() + " --rig euroc --seed 9 --duration 6")
                .exit_code,
            0);
  fs::copy(session(), copy, fs::copy_options::recursive);
  const Outcome outcome =
      score(ours(), other, "--no-imu --held-out " + session().string() + "," + copy.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const auto scores = document().at("scores");
  ASSERT_EQ(scores.size(), 3u);
  EXPECT_EQ(scores.at(0).at("held_out"), true);
  EXPECT_EQ(scores.at(1).at("held_out"), false);
  EXPECT_EQ(scores.at(2).at("held_out"), false);
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("other, held out"), HasSubstr("is not held out")));
  // A file that does not say has only the user's word, except for one recording given twice.
  const std::string kalibr = (root_ / "own" / "camchain-imucam.yaml").string();
  ASSERT_EQ(score(kalibr, other, "--no-imu --held-out " + session().string() + "," + other.string())
                .exit_code,
            0);
  EXPECT_EQ(document().at("scores").at(0).at("held_out"), false);
  EXPECT_EQ(document().at("scores").at(1).at("held_out"), true);
  EXPECT_EQ(document().at("scores").at(2).at("held_out"), false);
}

TEST_F(EvaluateCalibration, ASecondCameraAloneIsScored) {
  const fs::path alone = scratch() / "alone";
  fs::create_directories(scratch());
  ASSERT_EQ(plumbline("calibrate " + session().string() +
                      " --only cam1 --models pinhole-radtan --no-halves --no-cache "
                      "--no-report --out " +
                      alone.string())
                .exit_code,
            0);
  const Outcome outcome =
      score((alone / "camchain-imucam.yaml").string(), session(), "--no-imu --only cam1");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_TRUE(document().at("scores").at(0).at("per_camera").contains("cam1"));
  EXPECT_EQ(document().at("scores").at(0).at("entropy_parameters").at(0), "cam1.fu");
}

TEST_F(EvaluateCalibration, ThePageAndTheFiguresAreMadeAgainFromTheRecord) {
  const fs::path out = scratch() / "out";
  ASSERT_EQ(score(ours(), session(), "--folds 2").exit_code, 0);
  const std::string page = read(out / "report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("Calibration scored, not estimated"),
                          HasSubstr("calibration.json: scored, not estimated here"),
                          HasSubstr("K-fold validation"), HasSubstr("all 2 folds")));
  EXPECT_EQ(page.find("this calibration can be used"), std::string::npos);
  const auto s = document().at("scores").at(0);
  EXPECT_EQ(s.at("camera_imu_entropy_parameters").size(), 7u);
  const std::string again = (scratch() / "again").string();
  const Outcome outcome =
      plumbline("report " + out.string() + " --out " + again + ".html --json " + again + ".json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(read(again + ".html"), page);
  EXPECT_EQ(read(again + ".json"), read(out / "evaluation.json"));
}

TEST_F(EvaluateCalibration, AnotherResolutionIsRefusedByTheFilesName) {
  auto json = nlohmann::json::parse(read(ours()));
  json["cameras"][1]["resolution"] = {640, 480};
  fs::create_directories(scratch());
  write(scratch() / "other.json", json.dump());
  expectRefusal(score((scratch() / "other.json").string(), session()), 2,
                AllOf(HasSubstr("other.json"), HasSubstr("cam1"), HasSubstr("640x480"),
                      HasSubstr("752x480")));
}

TEST_F(EvaluateCalibration, AMissingCameraIsRefusedByTheFilesName) {
  auto json = nlohmann::json::parse(read(ours()));
  json["cameras"][1]["name"] = "cam7";
  json["cameras"][1]["rostopic"] = "/cam7/image_raw";
  fs::create_directories(scratch());
  const std::string file = (scratch() / "edited.json").string();
  write(file, json.dump());
  expectRefusal(score(file, session()), 2, AllOf(HasSubstr("edited.json"), HasSubstr("cam1")));
  expectRefusal(score((scratch() / "none.yaml").string(), session()), 2, HasSubstr("none.yaml"));
}

TEST_F(EvaluateCalibration, ASessionWithoutCornersHasNoScore) {
  const fs::path folder = spoiled();
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().filename() != "corners.csv") continue;
    write(entry.path(), "#timestamp [ns],corner_id,u [px],v [px]\n");
  }
  const Outcome outcome = score(ours(), folder);
  EXPECT_NE(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("corner"));
  EXPECT_FALSE(fs::exists(scratch() / "out"));
}

TEST_F(EvaluateCalibration, OneFoldIsNone) {
  const Outcome outcome = score(ours(), session(), "--folds 1");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("--folds"));
}

TEST_F(EvaluateCalibration, NothingIsWrittenIntoTheRecording) {
  const Outcome outcome = plumbline("evaluate calibration " + ours() + " " + session().string() +
                                    " --out " + (session() / "out").string());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("never written to"));
}

}  // namespace
}  // namespace plumbline
