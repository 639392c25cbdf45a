// SPDX-License-Identifier: BSD-3-Clause
// `plumbline odometry` as a user runs it with the built-in one, on rendered images and on corners.
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "evaluate/results/text.h"
#include "tests/evaluate/odometry/odometry_scratch.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class BuiltInOdometry : public test::OdometryScratch {};

// Two seconds of rendered images, and what may be wrong with them and with the calibration.
TEST_F(BuiltInOdometry, RenderedImagesAndWhatTheyMayLack) {
  const std::string flight = (folder_ / "flight").string();
  const Outcome made = plumbline(
      "simulate sequence --rig tumvi --images --duration 2 --turns 0 --rests 0 --first-rest 0 "
      "--out " +
      flight);
  ASSERT_EQ(made.exit_code, 0) << made.text;
  const fs::path truth = flight + "/truth/camchain-imucam.yaml";
  const auto with = [&](const fs::path& calibration, const std::string& more = "") {
    return odometry(flight + " --calibration " + calibration.string() + " --truth " + flight +
                    "/truth/trajectory.csv --clock-offset auto " + more);
  };
  const auto edited = [&](const std::string& from, const std::string& to) {
    write(folder_ / "edited.yaml", replaced(read(truth), from, to));
    return folder_ / "edited.yaml";
  };
  const auto refusedWith = [](const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(words));
  };
  refusedWith(with(edited("512, 512", "640, 480")), "it belongs to another rig");
  write(folder_ / "later.txt", "9000 0 0 0 0 0 0 1\n9001 1 0 0 0 0 0 1\n9002 2 1 0 0 0 0 1\n");
  const Outcome apart = odometry(flight + " --calibration " + truth.string() + " --truth " +
                                 (folder_ / "later.txt").string());
  EXPECT_EQ(apart.exit_code, 0) << apart.text;
  EXPECT_THAT(document()["runs"][0]["problem"].get<std::string>(),
              AllOf(testing::StartsWith("runs/camchain-imucam/flight_1.txt against"),
                    HasSubstr("no overlap in time")));

  fs::remove(*fs::directory_iterator(flight + "/mav0/cam0/data"));
  // An offset of the second camera's own, which it does not know.
  std::string own = read(truth);
  own.insert(own.find(' ', own.rfind("timeshift_cam_imu")) + 1, "0.003  # ");
  write(folder_ / "own.yaml", own);
  ASSERT_EQ(with(folder_ / "own.yaml").exit_code, 0);
  const nlohmann::json run = document()["runs"][0];
  EXPECT_THAT(run["remarks"].dump(), HasSubstr("takes all cameras as exposed together"));
  EXPECT_EQ(run["odometry"]["frames_skipped"], 1);
  EXPECT_THAT(run["remarks"].dump(), HasSubstr("1 images are missing or damaged"));
  EXPECT_LT(run["ate"]["translation_m"]["rmse"], 0.02);

  // The second camera exposes 4 ms later.
  const fs::path second = flight + "/mav0/cam1";
  write(second / "data.csv", replaceAll(read(second / "data.csv"), "3456789", "7456789"));
  fs::rename(second / "data", second / "on_time");
  fs::create_directories(second / "data");
  for (const auto& image : fs::directory_iterator(second / "on_time")) {
    const std::string name = image.path().filename().string();
    fs::rename(image.path(), second / "data" / replaced(name, "3456789", "7456789"));
  }
  refusedWith(with(truth), "expected cameras that are exposed at the same time");
  fs::remove_all(second);
  refusedWith(with(truth), "has 1 cameras, the calibration 2");

  const fs::path samples = flight + "/mav0/imu0/data.csv";
  const std::string rows = read(samples);
  const std::size_t third = rows.find('\n', rows.find('\n', rows.size() / 2) + 1) + 1;
  write(samples, rows.substr(0, third) + rows.substr(rows.find('\n') + 1));
  refusedWith(with(truth), "data.csv:");
}

// In step, though it saw the board in a third of the first one's frames; and 4 ms behind.
TEST_F(BuiltInOdometry, ACameraMaySeePointsMoreRarelyThanTheFirst) {
  const std::string board = (folder_ / "board").string();
  ASSERT_EQ(plumbline("simulate --duration 3 --seed 3 --out " + board).exit_code, 0);
  const fs::path list = board + "/mav0/cam1/corners.csv";
  std::istringstream all(read(list));
  std::string rarely, late, line, before;
  for (int frame = -1; std::getline(all, line);) {
    const std::string stamp = line.substr(0, line.find(','));
    frame += stamp != before ? 1 : 0;
    before = stamp;
    if (frame % 3 == 0) rarely += line + "\n";
    late += (frame == 0 ? line : replaced(line, "3456789,", "7456789,")) + "\n";
  }
  const std::string words =
      board + " --no-report --calibration " + board + "/truth/camchain-imucam.yaml";
  write(list, rarely);
  fs::rename(board + "/imu.yaml", folder_ / "imu.yaml");
  fs::remove(board + "/mav0/imu0/sensor.yaml");
  const Outcome in_step = odometry(words);
  EXPECT_EQ(in_step.exit_code, 0) << in_step.text;
  const std::string assumed = "neither calibration nor sequence states the IMU's noise densities";
  EXPECT_THAT(document()["runs"][0]["remarks"].dump(), HasSubstr(assumed));
  EXPECT_EQ(odometry(words + " --imu " + (folder_ / "imu.yaml").string()).exit_code, 0);
  EXPECT_THAT(document()["runs"][0]["remarks"].dump(), testing::Not(HasSubstr(assumed)));
  write(list, late);
  const Outcome behind = odometry(words);
  EXPECT_EQ(behind.exit_code, 2);
  EXPECT_THAT(behind.text, AllOf(HasSubstr("0 of "), HasSubstr("exposed at the same time")));
}

}  // namespace
}  // namespace plumbline
