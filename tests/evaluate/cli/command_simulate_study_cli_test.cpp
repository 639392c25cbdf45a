// SPDX-License-Identifier: BSD-3-Clause
// `plumbline simulate study` as a user runs it: a folder that the program's own commands read, the
// same bytes by any number of threads.
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

fs::path freshFolder(const char* name) {
  fs::path out = fs::path(::testing::TempDir()) / name;
  fs::remove_all(out);
  return out;
}

TEST(CommandSimulateStudy, WritesAStudyThatOurCommandsRead) {
  const std::string options =
      "simulate study --participants 1 --duration 5 --held-out 1 --sequences 1 ";
  const fs::path one = freshFolder("simulate_study_1"), two = freshFolder("simulate_study_2");
  const Outcome made = plumbline(options + "--threads 1 --out " + one.string());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  EXPECT_THAT(made.text, HasSubstr("Simulated 2 sessions of 1 participants"));
  EXPECT_EQ(plumbline(options + "--threads 2 --out " + two.string()).exit_code, 0);
  EXPECT_EQ(contents(one), contents(two));
  const auto truth = nlohmann::json::parse(read(one / "truth.json"));
  EXPECT_EQ(truth.at("sessions").size(), 2U);
  EXPECT_EQ(truth.at("board").at("terms").at("z_xx"), 0.3e-3);
  EXPECT_THAT(read(one / "STUDY.yaml"), HasSubstr("name: p01_guided, participant: p01"));
  // A guided recording is understood by the replay, its suggestions too.
  const fs::path out = freshFolder("simulate_study_replay");
  const Outcome replay = plumbline("replay " + (one / "sessions/p01_guided").string() +
                                   " --no-report --out " + out.string());
  ASSERT_EQ(replay.exit_code, 0) << replay.text;
  EXPECT_TRUE(nlohmann::json::parse(read(out / "replay.json")).contains("compliance"));
  fs::remove_all(one), fs::remove_all(two), fs::remove_all(out);
}

TEST(CommandSimulateStudy, NamesAnOptionOutOfItsRange) {
  const Outcome bad = plumbline("simulate study --participants 0 --out nowhere");
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.text, HasSubstr("--participants"));
}

}  // namespace
}  // namespace plumbline
