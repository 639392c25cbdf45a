// SPDX-License-Identifier: BSD-3-Clause
// `plumbline simulate sequence` as a user runs it: a folder that `plumbline odometry` runs as it
// is, against the exact truth and against motion capture.
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class SimulatedSequence : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("plumbline_sequence_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path simulate(const std::string& name, const std::string& options) const {
    const fs::path place = folder_ / name;
    const Outcome outcome = plumbline("simulate sequence " + options + " --out " + place.string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr("plumbline odometry " + place.string()));
    return place;
  }

  /// The one run of the sequence with the true calibration.
  json run(const fs::path& sequence, const std::string& options) const {
    const fs::path out = folder_ / "loop";
    const Outcome outcome =
        plumbline("odometry " + sequence.string() + " --calibration " +
                  (sequence / "truth/camchain-imucam.yaml").string() + " --clock-offset auto " +
                  options + " --force --out " + out.string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return json::parse(read(out / "odometry.json"))["runs"][0];
  }

  fs::path folder_;
};

TEST_F(SimulatedSequence, TracksAreRunAsTheyAre) {
  const fs::path flight = simulate("flight", "--duration 12 --seed 5 --tracks 80");
  const json exact = run(flight, "--truth " + (flight / "truth/trajectory.csv").string());
  EXPECT_EQ(exact["status"], "complete");
  EXPECT_LT(exact["ate"]["translation_m"]["rmse"], 0.03);
  // The truth is in the IMU's clock, the estimate in the cameras'; the clocks' offset is found to
  // 0.3 ms from rates of gyro noise and poses.
  const json truth = json::parse(read(flight / "truth/truth.json"));
  EXPECT_NEAR(exact["clock_offset"]["offset_s"].get<double>(), 0.0021, 3e-4);
  // Motion capture: its own clock, world and marker body.
  const json seen = run(flight, "--hand-eye auto");
  EXPECT_EQ(seen["status"], "complete");
  EXPECT_THAT(seen["truth"].get<std::string>(), HasSubstr("mocap0"));
  EXPECT_LT(seen["ate"]["translation_m"]["rmse"], 0.03);
  EXPECT_NEAR(seen["clock_offset"]["offset_s"].get<double>(),
              0.0021 - truth["motion_capture"]["clock_offset_s"].get<double>(), 5e-4);
  EXPECT_EQ(truth["motion_capture"]["gaps_s"].size(), 2U);
  EXPECT_GT(truth["length_m"], 5);
}

TEST_F(SimulatedSequence, SameSeedSameBytes) {
  const fs::path a = simulate("a", "--duration 3 --seed 9"),
                 b = simulate("b", "--duration 3 --seed 9");
  const fs::path c = simulate("c", "--duration 3 --seed 10");
  for (const char* file : {"mav0/cam1/tracks.csv", "mav0/imu0/data.csv", "mav0/mocap0/data.csv",
                           "truth/trajectory.csv", "truth/landmarks.csv", "truth/tracks.csv"}) {
    EXPECT_EQ(read(a / file), read(b / file)) << file;
    EXPECT_NE(read(a / file), read(c / file)) << file;
  }
}

TEST_F(SimulatedSequence, AFractionOfASecondIsNotNone) {
  const std::string out = (folder_ / "short").string();
  EXPECT_THAT(plumbline("simulate --duration 0.2 --out " + out).text,
              HasSubstr("Simulated 0.2 s of rig euroc"));
  EXPECT_THAT(
      plumbline("simulate sequence --duration 0.4 --rests 0 --turns 0 --out " + out + "2").text,
      HasSubstr("Simulated a flight of 0.4 s and"));
}

TEST_F(SimulatedSequence, RestsAndTurnsThatDoNotFitAreSaid) {
  const fs::path flight = folder_ / "flight";
  const Outcome outcome =
      plumbline("simulate sequence --duration 12 --rests 6 --turns 20 --out " + flight.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json truth = json::parse(read(flight / "truth/truth.json"));
  const std::size_t rests = truth["rests_s"].size() - 1;  // the first is before take-off
  EXPECT_LT(rests, 6U);
  EXPECT_EQ(truth["options"]["rests"], rests);
  const int turns = truth["options"]["turns"];
  EXPECT_LT(turns, 20);
  EXPECT_THAT(outcome.text, HasSubstr("Only " + std::to_string(rests) + " of 6 rests and " +
                                      std::to_string(turns) + " of 20 turns fit"));
  EXPECT_EQ(read(simulate("again", "--duration 12 --rests " + std::to_string(rests) + " --turns " +
                                       std::to_string(turns)) /
                 "mav0/imu0/data.csv"),
            read(flight / "mav0/imu0/data.csv"));
}

TEST_F(SimulatedSequence, RenderedImagesAreRunAsTheyAre) {
  const fs::path flight =
      simulate("flight", "--rig tumvi --duration 3 --seed 2 --first-rest 0.5 --images");
  EXPECT_FALSE(fs::exists(flight / "mav0/cam0/tracks.csv"));
  const json exact =
      run(flight, "--min-coverage 0.7 --truth " + (flight / "truth/trajectory.csv").string());
  EXPECT_EQ(exact["status"], "complete") << exact["problem"];
  EXPECT_LT(exact["ate"]["translation_m"]["rmse"], 0.02);
}

// Two calibrations, one with a focal length and a time offset that are wrong: without truth by what
// the odometry says of itself; with it, which of the two costs what.
class TwoCalibrations : public SimulatedSequence {
 protected:
  void SetUp() override {
    SimulatedSequence::SetUp();
    flight_ = simulate("flight", "--duration 6 --seed 3 --first-rest 1 --tracks 60");
    fs::copy_file(flight_ / "truth/camchain-imucam.yaml", folder_ / "true.yaml");
    const std::string text = read(folder_ / "true.yaml");
    write(folder_ / "wrong.yaml",
          replaced(replaced(text, "[458.654, ", "[467.8, "), "imu: 0.0021", "imu: 0.0026"));
  }

  json document(const std::string& options) const {
    const Outcome outcome = plumbline("odometry " + flight_.string() + " --calibration " +
                                      (folder_ / "true.yaml").string() + " --calibration " +
                                      (folder_ / "wrong.yaml").string() + " --force --out " +
                                      (folder_ / "loop").string() + " " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return json::parse(read(folder_ / "loop/odometry.json"));
  }

  fs::path flight_;
};

TEST_F(TwoCalibrations, WithoutTruthByWhatTheOdometrySaysOfItself) {
  fs::remove_all(flight_ / "mav0/mocap0");
  fs::remove_all(flight_ / "truth");
  const json all = document("");
  ASSERT_EQ(all["runs"].size(), 2U);
  const json right = all["runs"][0], wrong = all["runs"][1];
  for (const json& run : {right, wrong}) {
    EXPECT_EQ(run["status"], "complete") << run["problem"];
    EXPECT_EQ(run["without_truth"], true);
    EXPECT_FALSE(run.contains("ate"));
    EXPECT_THAT(run["remarks"].dump(), HasSubstr("no ground truth"));
    EXPECT_GT(run["odometry"]["closure_m"], 0);
    EXPECT_LE(run["odometry"]["frame_p50_ms"], run["odometry"]["frame_p99_ms"]);
  }
  // 0.5 px of noise in each image, across the line: 0.48 px in the median.
  EXPECT_NEAR(right["odometry"]["stereo_px"].get<double>(), 0.48, 0.03);
  EXPECT_GT(wrong["odometry"]["stereo_px"], right["odometry"]["stereo_px"]);
  EXPECT_GT(wrong["odometry"]["innovation_px"], right["odometry"]["innovation_px"]);
  EXPECT_TRUE(all["paired"][0]["pairs"] == 0);
  const std::string page = read(folder_ / "loop/report.html");
  EXPECT_THAT(page, HasSubstr("has no ground truth"));
  EXPECT_THAT(page, HasSubstr("Self-consistency of the odometry"));
}

TEST_F(TwoCalibrations, SensitivityNamesWhatCosts) {
  const json all = document("--sensitivity --clock-offset auto --truth " +
                            (flight_ / "truth/trajectory.csv").string());
  ASSERT_EQ(all["sensitivity"].size(), 1U);
  const json s = all["sensitivity"][0];
  EXPECT_EQ(s["calibration"], "true");
  EXPECT_EQ(s["towards"], "wrong");
  ASSERT_EQ(s["parameters"].size(), 2U);
  double sum = 0;
  for (const json& p : s["parameters"]) {
    EXPECT_TRUE(p["name"] == "cam0.fu" || p["name"] == "time_offset") << p["name"];
    sum += p["change_m"].get<double>();
  }
  EXPECT_EQ(s["parameters"][0]["name"], "cam0.fu");
  EXPECT_GT(s["parameters"][0]["change_m"], 0.002);
  const json& runs = all["runs"];
  const auto ate = [&](int i) { return runs[i]["ate"]["translation_m"]["rmse"].get<double>(); };
  EXPECT_NEAR(s["ate_m"].get<double>(), ate(0), 1e-9);
  EXPECT_NEAR(s["whole_m"].get<double>(), ate(1) - ate(0), 1e-9);
  EXPECT_NEAR(s["sum_m"].get<double>(), sum, 1e-12);
  EXPECT_NEAR(s["interaction_m"].get<double>(), ate(1) - ate(0) - sum, 1e-9);
  EXPECT_LT(s["noise_m"], 0.002);
  EXPECT_NE(read(folder_ / "loop/report.html").find("cam0.fu has the largest effect"),
            std::string::npos);
}

TEST_F(SimulatedSequence, BadValuesAreNamed) {
  const auto expect = [](const std::string& option, const std::vector<std::string>& ends,
                         const std::vector<std::string>& outside) {
    expectRange("simulate sequence", option, ends, outside);
  };
  expect("--duration", {"0.001", "100000"}, {"0", "nan"});
  expect("--pace", {"0.01", "10"}, {"0", "11"});
  expect("--first-rest", {"0", "10000"}, {"-1", "nan"});
  expect("--rests", {"0", "1000"}, {"-1", "1001"});
  expect("--turns", {"0", "1000"}, {"-1", "1001"});
  expect("--time-offset-ms", {"-1e+06", "1e+06"}, {"-1.1e6", "nan"});
  expect("--tracks", {"1", "100000"}, {"0", "100001"});
  expect("--track-sigma", {"0", "100"}, {"-1", "nan"});
  expect("--outliers", {"0", "1"}, {"-1", "2"});
  expect("--images --exposure-ms", {"0", "1000"}, {"-1", "1001"});
  expect("--drop-outs", {"0", "100"}, {"-1", "101"});
}

TEST_F(SimulatedSequence, TracksArePointsOfTheScene) {
  // Numbered from 0.
  const fs::path flight = simulate("flight", "--duration 2");
  const fs::path list = flight / "mav0/cam0/tracks.csv";
  std::string text = read(list);
  const std::size_t comma = text.find(',', text.find('\n') + 1);
  text.replace(comma + 1, text.find(',', comma + 1) - comma - 1, "-4");
  write(list, text);
  const Outcome outcome = plumbline("odometry " + flight.string() + " --calibration " +
                                    (flight / "truth/camchain-imucam.yaml").string() + " --out " +
                                    (folder_ / "loop").string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("track_id -4"));
}

}  // namespace
}  // namespace plumbline
