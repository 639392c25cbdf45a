// SPDX-License-Identifier: BSD-3-Clause
// `plumbline replay` as a user runs it.
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_replay.h"

namespace plumbline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(CommandReplay, OneLineAFrameAndAPageFromTheRecordsWhateverTheThreads) {
  const auto before = contents(session());
  const Outcome run = replay(session(), "--threads 3");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("camera stage:"));
  const auto decisions = lines(out() / "decisions.jsonl");
  const json document = json::parse(read(out() / "replay.json"));
  EXPECT_EQ(decisions.size(), document["frames"].get<std::size_t>());
  EXPECT_EQ(decisions.front()["reason"], "initialising");
  int accepted = 0;
  for (const json& d : decisions) {
    if (d["stage"] == "camera") {
      accepted += (d["accepted"].get<bool>() ? 1 : 0) - static_cast<int>(d["withdrawn"].size());
    }
    if (d["reason"] != "not-informative") continue;
    EXPECT_LT(d["mi_bits"].get<double>(), 0.2);
  }
  EXPECT_EQ(document["stages"][0]["views_used"], accepted);
  const Outcome again =
      plumbline("report " + out().string() + " --out " + (scratch() / "again.html").string() +
                " --json " + (scratch() / "again.json").string());
  ASSERT_EQ(again.exit_code, 0) << again.text;
  EXPECT_EQ(read(scratch() / "again.html"), read(out() / "report.html"));
  EXPECT_EQ(read(scratch() / "again.json"), read(out() / "replay.json"));
  EXPECT_EQ(contents(session()), before);
  // The log does not depend on the threads. The command line is stated as it was given; the options
  // are those that a result depends on.
  const std::string three = read(out() / "decisions.jsonl");
  const std::string three_document = read(out() / "replay.json");
  ASSERT_EQ(replay(session(), "--threads 1").exit_code, 0);
  EXPECT_TRUE(read(out() / "decisions.jsonl") == three);
  EXPECT_TRUE(replaced(three_document, "--threads 3", "--threads 1") ==
              read(out() / "replay.json"));
}

TEST_F(CommandReplay, LatencyDropsFramesAndCountsThem) {
  ASSERT_EQ(replay(session(), "--no-report --to 6 --latency-ms camera-frame=120").exit_code, 0);
  const json document = json::parse(read(out() / "replay.json"));
  int busy = 0;
  for (const json& d : lines(out() / "decisions.jsonl")) busy += d["reason"] == "busy" ? 1 : 0;
  EXPECT_GT(busy, 0);
  int dropped = 0;
  for (const json& stage : document["stages"]) dropped += stage["frames_dropped"].get<int>();
  EXPECT_EQ(dropped, busy);
}

TEST_F(CommandReplay, GivenCamerasLeaveTheImuStageAlone) {
  const Outcome run = replay(session(), "--no-report --to 6" + givenCameras());
  ASSERT_EQ(run.exit_code, 0) << run.text;
  const json document = json::parse(read(out() / "replay.json"));
  ASSERT_EQ(document["stages"].size(), 1u);
  EXPECT_EQ(document["stages"][0]["stage"], "camera-imu");
  EXPECT_GT(document["stages"][0]["views_used"].get<int>(), 50);  // nearly all
}

TEST_F(CommandReplay, GivenCamerasDoNotKeepOtherChoicesFromBeingTried) {
  const Outcome run =
      plumbline("replay --force " + session().string() + " --out " + out().string() +
                " --no-cache --no-report --random-orders 1 " + "--to 6" + givenCameras());
  ASSERT_EQ(run.exit_code, 0) << run.text;
  const json document = json::parse(read(out() / "replay.json"));
  // recorded, random, greedy-mi, predicted-error, coverage; no guide chose views.
  EXPECT_EQ(document["counterfactuals"]["bands"].size(), 5u);
}

TEST_F(CommandReplay, ByPredictedErrorItStopsWithFewViewsAndSaysHowGoodTheyAre) {
  const Outcome run = replay(session(),
                             "--no-report --no-imu --loss none --criterion predicted-error "
                             "--stop-excess 5");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  const json document = json::parse(read(out() / "replay.json"));
  bool scored = false;
  for (const json& d : lines(out() / "decisions.jsonl")) {
    if (!d["error_bound_px"].is_number()) continue;
    scored = true;
    if (d["reason"] == "bad-fit") continue;
    EXPECT_EQ(d["accepted"].get<bool>(),
              d["error_with_px"].get<double>() <= d["error_bound_px"].get<double>());
  }
  EXPECT_TRUE(scored);
  const json& audit = document["stop_audits"][0];
  EXPECT_TRUE(audit["predicted_excess"].is_number());
  EXPECT_TRUE(audit["held_out_excess"].is_number());
  EXPECT_TRUE(audit["measured_excess"].is_number());
}

TEST_F(CommandReplay, AStageThatWasNotPlayedIsNotJudged) {
  // Too short for the camera stage to finish, and its user lets it take as long as it wants.
  ASSERT_EQ(replay(session(), "--no-report --to 4 --camera-stage-s 1000").exit_code, 0);
  const json document = json::parse(read(out() / "replay.json"));
  ASSERT_EQ(document["stages"].size(), 2u);
  ASSERT_EQ(document["stop_audits"].size(), 2u);
  EXPECT_EQ(document["stop_audits"][1]["stage"], "camera-imu");
  EXPECT_EQ(document["stop_audits"][1]["verdict"], "not judged");
}

TEST_F(CommandReplay, AStageThatWasLeftOutIsNotJudgedEither) {
  const auto audits = [&](const std::string& options) {
    EXPECT_EQ(replay(session(), "--no-report --to 3" + options).exit_code, 0);
    return json::parse(read(out() / "replay.json"))["stop_audits"];
  };
  const json given = audits(givenCameras());
  ASSERT_EQ(given.size(), 2u);
  EXPECT_EQ(given[0]["stage"], "camera");
  EXPECT_EQ(given[0]["explanation"], "not judged: the cameras are given");
  EXPECT_EQ(given[1]["stage"], "camera-imu");
  const json no_imu = audits(" --no-imu");
  ASSERT_EQ(no_imu.size(), 2u);
  EXPECT_EQ(no_imu[1]["verdict"], "not judged");
  EXPECT_EQ(no_imu[1]["explanation"], "not judged: the IMU is left out (--no-imu)");
}

TEST_F(CommandReplay, ACameraStageThatTakesAllIsEndedAtHalf) {
  const Outcome run = replay(session(), "--no-report --to 8 --min-views 10000");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("ended at 4.0 s without a stop"));
  EXPECT_THAT(run.text, HasSubstr("in the whole recording of 8"));
  const json document = json::parse(read(out() / "replay.json"));
  EXPECT_TRUE(document["stages"][0]["ended_ns"].is_number());
  EXPECT_FALSE(document["stages"][0].contains("finished_ns"));
  EXPECT_EQ(document["stop_audits"][0]["verdict"], "never stopped");
  EXPECT_GT(document["stages"][1]["frames_offered"], 0);
  EXPECT_NE(document["stop_audits"][1]["verdict"], "not judged");
  EXPECT_TRUE(document["stop_audits"][1]["predicted_px"].is_number());
  // Still one decision a frame.
  const auto decisions = lines(out() / "decisions.jsonl");
  for (std::size_t i = 0; i < decisions.size(); ++i) EXPECT_EQ(decisions[i]["frame"], i);
}

TEST_F(CommandReplay, AStopWithTheLastFrameIsAStop) {
  ASSERT_EQ(replay(session(),
                   "--no-report --loss none --criterion predicted-error --stop-excess 50 --to 4")
                .exit_code,
            0);
  const json whole = json::parse(read(out() / "replay.json"))["stages"][0];
  ASSERT_TRUE(whole["finished_ns"].is_number());
  const auto first = lines(out() / "decisions.jsonl").front()["t_ns"].get<std::int64_t>();
  const double stop_s =
      1e-9 * static_cast<double>(whole["finished_ns"].get<std::int64_t>() - first);
  ASSERT_EQ(
      replay(session(),
             fmt::format(
                 "--no-report --loss none --criterion predicted-error --stop-excess 50 --to {:.4f}",
                 stop_s + 1e-3))
          .exit_code,
      0);
  const json cut = json::parse(read(out() / "replay.json"))["stages"][0];
  EXPECT_EQ(cut["finished_ns"], whole["finished_ns"]);
  EXPECT_FALSE(cut.contains("ended_ns"));
}

TEST_F(CommandReplay, ACameraStageHasTheTimeAskedFor) {
  const Outcome run = replay(session(), "--no-report --to 8 --min-views 10000 --camera-stage-s 3");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("before its stage was ended at 3.0 s"));
}

TEST_F(CommandReplay, TheBatchOfAStageThatWasEndedTakesItsTime) {
  const Outcome run = replay(session(),
                             "--no-report --to 8 --min-views 10000 --camera-stage-s 3 "
                             "--latency-ms camera-batch=1000");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  int busy = 0;
  for (const json& d : lines(out() / "decisions.jsonl")) busy += d["reason"] == "busy" ? 1 : 0;
  EXPECT_NEAR(busy, 10, 1);  // a second at 10 Hz
}

TEST_F(CommandReplay, SuggestionsOfTheRecordingAreFollowed) {
  const fs::path folder = spoiled();
  write(folder / "suggestions.csv",
        "#t_ns,stage,id,T_FC0\n1400000001000000000,camera,0,0.3,0.3,1.2,1,0,0,0\n");
  ASSERT_EQ(replay(folder, "--no-report --to 4").exit_code, 0);
  const json document = json::parse(read(out() / "replay.json"));
  ASSERT_EQ(document["compliance"]["suggestions"].size(), 1u);
  write(folder / "suggestions.csv", "#t_ns,stage,id,T_FC0\n1400000001000000000,view,0,0,0,1\n");
  fs::remove_all(out());
  expectRefusal(replay(folder), 2, HasSubstr("suggestions.csv:2:"));
}

TEST_F(CommandReplay, SuggestionsAreNotJudgedWithoutCameras) {
  const fs::path folder = spoiled();
  write(folder / "suggestions.csv",
        "#t_ns,stage,id,T_FC0\n1400000000150000000,camera,0,0.3,0.3,1.2,1,0,0,0\n");
  const Outcome run = replay(folder, "--no-report --to 0.05");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, Not(HasSubstr("operator: reached")));
  const json document = json::parse(read(out() / "replay.json"));
  EXPECT_TRUE(document.value("compliance", json()).is_null());
}

// More corners than the target has.
TEST_F(CommandReplay, ViewsThatTheBatchesWouldIgnoreAreNoneToTheGuide) {
  const Outcome run = replay(session(), "--no-report --no-imu --to 1 --min-corners 145");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  const std::vector<json> decisions = lines(out() / "decisions.jsonl");
  EXPECT_FALSE(decisions.empty());
  for (const json& d : decisions) EXPECT_EQ(d["reason"], "no-target");
}

TEST_F(CommandReplay, WithoutImuTheCameraStageIsAll) {
  const Outcome run = replay(session(), "--no-report --no-imu --to 6");
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_EQ(json::parse(read(out() / "replay.json"))["stages"].size(), 1u);
  EXPECT_THAT(run.text, Not(HasSubstr("camera-imu")));
}

// The IMU that an option leaves out is not missing in the recording.
TEST_F(CommandReplay, GivenCamerasWithoutImuLeaveNothingToReplay) {
  fs::create_directories(scratch());
  const std::string cameras = (scratch() / "cameras.yaml").string();
  fs::copy(session() / "truth" / "camchain-imucam.yaml", cameras);
  const Outcome run = replay(session(), "--no-report --no-imu --to 1 --cameras " + cameras);
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("the IMU is left out (--no-imu): there is no stage to replay"));
  EXPECT_THAT(run.text, HasSubstr("replay without --no-imu"));
}

// Long after the views were enough: by the option that decides when it stops.
TEST_F(CommandReplay, ALateStopNamesTheOptionThatDecidesIt) {
  const std::string options = "--no-report --no-imu --to 8 --stop-tolerance-s 0 ";
  const Outcome in_px = replay(session(), options + "--stop-projection-px 0.5 --min-views 40");
  ASSERT_EQ(in_px.exit_code, 0) << in_px.text;
  EXPECT_THAT(in_px.text,
              HasSubstr("Raise --stop-projection-px, or require fewer views (--min-views).\n"));
  const Outcome by_excess = replay(
      session(),
      options + "--criterion predicted-error --stop-excess 50 --min-views 20 --sufficient-px 5");
  ASSERT_EQ(by_excess.exit_code, 0) << by_excess.text;
  EXPECT_THAT(by_excess.text,
              HasSubstr("Raise --stop-excess, or require fewer views (--min-views).\n"));
}

// The guide is judged by what the recording is: cameras of another one would make it seem so.
TEST_F(CommandReplay, CamerasThatAreNotTheRecordingsAreACaution) {
  fs::create_directories(scratch());
  const std::string right = (scratch() / "right.yaml").string();
  const std::string wrong = (scratch() / "wrong.yaml").string();
  const std::string text = read(session() / "truth" / "camchain-imucam.yaml");
  write(right, text);
  const auto at = text.find("intrinsics: [") + 13;
  const double fu = std::stod(text.substr(at));
  write(wrong, text.substr(0, at) + std::to_string(1.02 * fu) + text.substr(text.find(',', at)));
  const auto rule = [&](const std::string& cameras) {
    const Outcome run = replay(session(), "--no-report --to 8 --cameras " + cameras);
    EXPECT_EQ(run.exit_code, 0) << run.text;
    const json verdict = json::parse(read(out() / "replay.json"))["verdict"];
    for (const json& f : verdict["findings"]) {
      if (f["rule"] == "Cameras against this recording") return std::string(f["level"]);
    }
    return std::string();
  };
  EXPECT_EQ(rule(right), "good");
  EXPECT_EQ(rule(wrong), "caution");
}

TEST_F(CommandReplay, AShapeOfAnotherBoardIsACaution) {
  fs::create_directories(scratch());
  const auto made = [&](const char* name, const std::string& options) {
    const std::string folder = (scratch() / name).string();
    EXPECT_EQ(plumbline("simulate --seed 5 --duration 10 --camera-rate 10 " + options + " --out " +
                        folder)
                  .exit_code,
              0);
    return folder;
  };
  const std::string bent = made("bent", "--target-shape bow=4mm"), even = made("even", "");
  const auto finding = [&](const std::string& session) {
    const Outcome run =
        replay(session, "--no-report --no-imu --no-counterfactuals --target-shape " + bent +
                            "/truth/target_shape.yaml --force");
    EXPECT_EQ(run.exit_code, 0) << run.text;
    const json verdict = json::parse(read(out() / "replay.json"))["verdict"];
    for (const json& f : verdict["findings"]) {
      if (f["rule"] == "Shape of the target") return f;
    }
    return json();
  };
  EXPECT_EQ(finding(bent)["level"], "good");
  const json other = finding(even);
  EXPECT_EQ(other["level"], "caution") << other;
  EXPECT_THAT(std::string(other["advice"]), HasSubstr("leave out --target-shape"));
}

TEST_F(CommandReplay, BadUsageLeavesNothing) {
  for (const char* options :
       {"--latency-ms frame=5", "--latency-ms camera-frame=x", "--latency-ms camera-frame=-1",
        "--latency-ms camera-frame=0x10", "--latency-ms 'camera-frame= 5'", "--threshold-bits 0",
        "--window 0", "--imu-window 1", "--suggestions none.csv", "--max-rate -3", "--reached-s -1",
        "--criterion error", "--later-use here", "--first-trajectory now", "--stop-excess 0"}) {
    expectRefusal(replay(session(), options), 2, Not(HasSubstr("terminate")));
  }
  // replay() gives --no-counterfactuals.
  for (const char* options : {"--random-orders 3", "--seed 9", "--no-images --no-report"}) {
    expectRefusal(replay(session(), options), 2, HasSubstr(" excludes --no-"));
  }
  expectRefusal(replay(session(), "--random-orders 0"), 2, HasSubstr("0: expected 1 or more;"));
  expectRefusal(replay(session(), "--stop-tolerance-s -1"), 2, HasSubstr("-1: expected 0 or more"));
}

}  // namespace
}  // namespace plumbline
