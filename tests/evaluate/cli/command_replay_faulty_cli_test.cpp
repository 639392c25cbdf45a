// SPDX-License-Identifier: BSD-3-Clause
// `plumbline replay` of recordings that have something wrong with them.
#include <cstdint>
#include <functional>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_replay.h"

namespace plumbline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class CommandReplayOfFaultyRecordings : public CommandReplay {
 protected:
  /// Rewrites a file of the spoiled session's mav0, keeping the rows that `keep` accepts.
  static void keepRows(const fs::path& file, const std::function<bool(int row)>& keep) {
    std::istringstream in(read(file));
    std::string kept;
    int row = -1;
    for (std::string line; std::getline(in, line);) {
      if (line[0] == '#' || keep(++row)) kept += line + "\n";
    }
    write(file, kept);
  }
  /// The spoiled session; of every four frames camera 1 stamps three up to 0.9 ms late, and one of
  /// these in every sixteen frames has no image of camera 0.
  fs::path withJitteryStamps() const {
    const fs::path folder = spoiled();
    for (const char* name : {"data.csv", "corners.csv"}) {
      const auto number = [](const std::string& line) {
        return (std::stoll(line) - 1'400'000'000'123'456'789) / 100'000'000;
      };
      std::string kept;
      std::istringstream first(read(folder / "mav0/cam0" / name));
      for (std::string line; std::getline(first, line);) {
        if (line[0] == '#' || number(line) % 16 != 3) kept += line + "\n";
      }
      write(folder / "mav0/cam0" / name, kept);
      kept.clear();
      std::istringstream second(read(folder / "mav0/cam1" / name));
      for (std::string line; std::getline(second, line);) {
        const auto late = line[0] == '#' ? 0 : number(line) % 4 * (100'000 + number(line) * 1'600);
        kept += line[0] == '#' ? line : std::to_string(std::stoll(line) + late) + line.substr(19);
        kept += "\n";
      }
      write(folder / "mav0/cam1" / name, kept);
    }
    return folder;
  }
  /// The spoiled session; of every frame between 4 s and 8 s the corners are gone, its stamp stays.
  fs::path withTargetLost() const {
    const fs::path folder = spoiled();
    for (const char* camera : {"cam0", "cam1"}) {
      const fs::path stream = folder / "mav0" / camera;
      std::istringstream in(read(stream / "corners.csv"));
      std::string kept;
      for (std::string line; std::getline(in, line);) {
        const bool lost = line[0] != '#' && std::stoll(line) > 1'400'000'004'000'000'000 &&
                          std::stoll(line) < 1'400'000'008'000'000'000;
        if (!lost) kept += line + "\n";
      }
      write(stream / "corners.csv", kept);
    }
    return folder;
  }
};

TEST_F(CommandReplayOfFaultyRecordings, TimesCountFromTheFirstFrameWhoseStampIsRight) {
  const fs::path folder = spoiled();
  const std::string first = "1400000000123456789", wrong = "1400000000";
  for (const char* file :
       {"cam0/data.csv", "cam0/corners.csv", "cam1/data.csv", "cam1/corners.csv"}) {
    const fs::path path = folder / "mav0" / file;
    write(path, std::regex_replace(read(path), std::regex("\n" + first + ","), "\n" + wrong + ","));
  }
  const Outcome run = replay(folder, "--no-report");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  const json document = json::parse(read(out() / "replay.json"));
  EXPECT_EQ(document["begin_ns"].get<std::int64_t>(), std::stoll(first) + 200'000'000);
  // Of a recording of 12 s none is hours in.
  EXPECT_THAT(run.text, Not(::testing::ContainsRegex("[0-9]{3,}[.][0-9] s")));
}

TEST_F(CommandReplayOfFaultyRecordings,
       SuggestionsOfAnotherHourBesideTheRecordingAreToldWithTheWayOut) {
  const fs::path folder = spoiled();
  const fs::path file = folder / "suggestions.csv";
  write(file, "#t_ns,stage,id,T_FC0\n1400003600000000000,camera,0,0.3,0.3,1.2,1,0,0,0\n");
  const std::string away = "it was found beside the recording: move it away";
  expectRefusal(replay(folder), 2, AllOf(HasSubstr(file.string() + ": none"), HasSubstr(away)));
  fs::rename(file, scratch() / "other.csv");
  expectRefusal(replay(folder, "--suggestions " + (scratch() / "other.csv").string()), 2,
                AllOf(HasSubstr("other.csv: none"), Not(HasSubstr(away))));
}

TEST_F(CommandReplayOfFaultyRecordings, ARecordingTooShortToStartSaysAtWhichFrame) {
  const Outcome run = replay(session(), "--no-report --to 0.1");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("never started"));
  EXPECT_THAT(run.text, HasSubstr("The reason for each frame is in decisions.jsonl."));
  EXPECT_EQ(json::parse(read(out() / "replay.json"))["verdict"]["level"], "bad");
}

TEST_F(CommandReplayOfFaultyRecordings, ATargetLostForLongIsSaidAndTheReplayGoesOn) {
  const fs::path folder = withTargetLost();
  ASSERT_EQ(replay(folder, "--no-report --no-imu").exit_code, 0);
  int without = 0;
  bool said = false;
  bool went_on = false;
  for (const json& d : lines(out() / "decisions.jsonl")) {
    without += d["reason"] == "no-target" ? 1 : 0;
    said = said || (d["reason"] == "no-target" && d["detail"] != "");
    went_on = went_on || (without > 0 && d["accepted"].get<bool>());
  }
  EXPECT_GT(without, 30);
  EXPECT_TRUE(said);
  EXPECT_TRUE(went_on);
}

TEST_F(CommandReplayOfFaultyRecordings, FramesStayApartUnderATighterToleranceOfStamps) {
  const fs::path folder = withJitteryStamps();
  const std::map<std::string, int> least_frames = {{"0", 120}, {"0.5", 85}};  // 81 were exposed
  for (const auto& [tolerance, least] : least_frames) {
    const Outcome run = plumbline("replay --force " + folder.string() + " --out " + out().string() +
                                  " --no-cache --no-report --no-imu --random-orders 1 --to 8 " +
                                  "--sync-tolerance-ms " + tolerance);
    ASSERT_EQ(run.exit_code, 0) << run.text;
    const auto decisions = lines(out() / "decisions.jsonl");
    const json document = json::parse(read(out() / "replay.json"));
    EXPECT_GT(document["frames"].get<int>(), least) << tolerance;
    // A view that is stamped alone is a frame to all who choose.
    const json& found = document["counterfactuals"];
    EXPECT_EQ(found.value("problem", ""), "");
    EXPECT_GT(found["pool_frames"].get<int>() + found["held_out_frames"].get<int>(), 50);
    for (const json& curve : found["curves"]) {
      std::set<std::size_t> frames;
      for (const json& frame : curve["order"]) frames.insert(frame.get<std::size_t>());
      EXPECT_EQ(frames.size(), curve["order"].size()) << curve["strategy"];
      EXPECT_LT(*frames.rbegin(), decisions.size());
    }
  }
}

TEST_F(CommandReplayOfFaultyRecordings, AnImuGapIsSaidAndTheReplayGoesOn) {
  const fs::path folder = spoiled();
  keepRows(folder / "mav0/imu0/data.csv", [](int row) { return row < 1000 || row > 1150; });
  const Outcome run = replay(folder, "--no-report --to 8" + givenCameras());
  ASSERT_EQ(run.exit_code, 0) << run.text;
  int gaps = 0;
  bool went_on = false;
  for (const json& d : lines(out() / "decisions.jsonl")) {
    if (d["reason"] == "no-imu" || d["reason"] == "imu-gap") ++gaps;
    went_on = went_on || (gaps > 0 && d["reason"] == "used");
  }
  EXPECT_GT(gaps, 0);
  EXPECT_TRUE(went_on);
}

TEST_F(CommandReplayOfFaultyRecordings, OtherOrdersNameTheRecordingsFrames) {
  const fs::path folder = withTargetLost();
  const Outcome run = plumbline("replay --force " + folder.string() + " --out " + out().string() +
                                " --no-cache --no-report --no-imu --random-orders 1");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  const auto decisions = lines(out() / "decisions.jsonl");
  const json found = json::parse(read(out() / "replay.json"))["counterfactuals"];
  std::size_t after_the_loss = 0;
  for (const json& curve : found["curves"]) {
    for (const json& frame : curve["order"]) {
      const json& decision = decisions.at(frame.get<std::size_t>());
      EXPECT_GT(decision["corners"].get<int>(), 0) << frame;
      if (curve["strategy"] == "guide") {
        EXPECT_TRUE(decision["accepted"].get<bool>()) << frame;
      }
      after_the_loss += decision["t_ns"].get<std::int64_t>() > 1'400'000'008'000'000'000 ? 1 : 0;
    }
  }
  EXPECT_GT(after_the_loss, 10U);
}

}  // namespace
}  // namespace plumbline
