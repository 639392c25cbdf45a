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
  const fs::path flight = simulate("flight", "--duration 20 --seed 5");
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

TEST_F(SimulatedSequence, RenderedImagesAreRunAsTheyAre) {
  const fs::path flight = simulate("flight", "--duration 5 --seed 2 --first-rest 1 --images");
  EXPECT_FALSE(fs::exists(flight / "mav0/cam0/tracks.csv"));
  const json exact =
      run(flight, "--min-coverage 0.7 --truth " + (flight / "truth/trajectory.csv").string());
  EXPECT_EQ(exact["status"], "complete") << exact["problem"];
  EXPECT_LT(exact["ate"]["translation_m"]["rmse"], 0.02);
}

TEST_F(SimulatedSequence, BadValuesAreNamed) {
  const Outcome bad = plumbline("simulate sequence --pace 0 --out " + (folder_ / "x").string());
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.text, HasSubstr("flight.pace"));
  // Tracks are points of the scene, numbered from 0.
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
