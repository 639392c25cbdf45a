// SPDX-License-Identifier: BSD-3-Clause
// A recording of ROS becomes a session, without ROS.
#include <nlohmann/json.hpp>

#include "tests/datasets/bag/bag_of_session.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A simulated recording of images, as a session and as a bag.
class CommandImport : public CommandLine {
 protected:
  static void SetUpTestSuite() {
    CommandLine::SetUpTestSuite();
    const Outcome outcome =
        plumbline("simulate --rig euroc --seed 5 --images --duration 2 --camera-rate 4 --out " +
                  recorded().string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    writeBagOf(recorded().string(), bag().string());
  }
  static fs::path recorded() { return root_ / "recorded"; }
  static fs::path bag() { return root_ / "bag.db3"; }
  static std::string files() {
    return " --target " + (recorded() / "target.yaml").string() + " --imu " +
           (recorded() / "imu.yaml").string();
  }
  Outcome import(const std::string& options) const {
    return plumbline("import " + bag().string() + " " + options);
  }
  std::string session() const { return (scratch() / "session").string(); }
};

TEST_F(CommandImport, TheSessionHasTheCornersAndSamplesOfTheRecording) {
  const Outcome outcome = import(files() + " --out " + session());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(withoutProgress(outcome.text),
              AllOf(HasSubstr("cam1: 8 images of 752 x 480 at 4 Hz over 1.8 s from "
                              "/cam1/image_raw\n"),
                    HasSubstr("at 200 Hz"), HasSubstr("Session: " + session())));
  const auto cornersOf = [&](const fs::path& folder, const std::string& name) {
    const fs::path out = scratch() / name;
    EXPECT_EQ(
        plumbline("detect " + folder.string() + " --no-cache --out " + out.string()).exit_code, 0);
    return out / "mav0";
  };
  const fs::path ours = cornersOf(session(), "ours"), theirs = cornersOf(recorded(), "theirs");
  for (const char* file : {"cam0/corners.csv", "cam1/corners.csv", "imu0/data.csv"}) {
    EXPECT_EQ(read(ours / file), read(theirs / file)) << file;
  }
}

TEST_F(CommandImport, ListsTheTopicsAndWritesNothing) {
  const Outcome outcome = import("--list");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("sensor_msgs/Image"), HasSubstr("/cam0/image_raw"),
                                  HasSubstr("sensor_msgs/Imu")));
  const auto topics = nlohmann::json::parse(import("--list --json -").text);
  ASSERT_EQ(topics.size(), 3U);
  EXPECT_EQ(topics[0]["name"], "/cam0/image_raw");
  EXPECT_EQ(topics[0]["messages"], 8);
}

TEST_F(CommandImport, SaysWhichFilesOtherCommandsWillAskFor) {
  const Outcome outcome = import("--camera-topics /cam1/image_raw --out " + session());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("cam0: 8 images"), HasSubstr("No target.yaml yet"),
                                  HasSubstr("No imu.yaml yet")));
  const Outcome without = import("--no-imu --force --out " + session());
  EXPECT_THAT(without.text, Not(HasSubstr("imu")));
}

TEST_F(CommandImport, WrongUseIsToldWithItsCureAndLeavesNothing) {
  const auto refused = [&](const std::string& options, const std::string& words) {
    const Outcome outcome = import(options);
    EXPECT_EQ(outcome.exit_code, 2) << options;
    EXPECT_THAT(outcome.text, HasSubstr(words));
    EXPECT_FALSE(fs::exists(session()));
  };
  refused("", "--out");
  refused("--list --out " + session(), "--list");
  const fs::path file = scratch() / "topics.json";
  refused("--list --json " + file.string(), "--json - for its topics");
  EXPECT_FALSE(fs::exists(file));
  refused("--camera-topics /left --out " + session(),
          "there is no topic /left; topics of the recording: /cam0/image_raw (sensor_msgs/Image)");
  refused("--camera-topics /cam0/image_raw,/cam0/image_raw --out " + session(), "given twice");
  refused("--threads -1 --out " + session(), "--threads");
  refused("--out " + bag().string(), bag().string());
  const Outcome other = plumbline("import " + recorded().string() + " --out " + session());
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.text, HasSubstr("a session in EuRoC's layout needs no import"));
}

TEST_F(CommandImport, OfSeveralImusOneIsToBeNamed) {
  fs::create_directories(scratch());
  const std::string path = (scratch() / "two.db3").string();
  {
    WrittenRos2Bag two(path);
    two.topic("/a/imu", "sensor_msgs/msg/Imu");
    two.topic("/b/imu", "sensor_msgs/msg/Imu");
    two.topic("/cam", "sensor_msgs/msg/Image");
  }
  const Outcome outcome = plumbline("import " + path + " --out " + session());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("/a/imu (sensor_msgs/Imu), /b/imu (sensor_msgs/Imu)"),
                                  HasSubstr("name it with --imu-topic")));
}

}  // namespace
}  // namespace plumbline
