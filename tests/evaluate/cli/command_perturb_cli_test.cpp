// SPDX-License-Identifier: BSD-3-Clause
// `plumbline perturb` as a user runs it.
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const fs::path& session() {
  static const fs::path folder = [] {
    const fs::path path = fs::path(::testing::TempDir()) / "command_perturb_session";
    fs::remove_all(path);
    EXPECT_EQ(plumbline("simulate --duration 5 --out " + path.string()).exit_code, 0);
    return path;
  }();
  return folder;
}

fs::path freshFolder(const char* name) {
  fs::path out = fs::path(::testing::TempDir()) / name;
  fs::remove_all(out);
  return out;
}

TEST(CommandPerturb, OneTableOfSeveralPerturbations) {
  const fs::path out = freshFolder("command_perturb_out");
  const auto before = contents(session());
  const Outcome run = plumbline("perturb " + session().string() +
                                " --offsets-ms -10:10:10,0.37 --corner-noise-px 0.3 --repeats 2 "
                                "--no-report --out " +
                                out.string());
  ASSERT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, HasSubstr("imu-shift +0.37 ms"));
  const auto json = nlohmann::json::parse(read(out / "perturbation.json"));
  ASSERT_EQ(json["cases"].size(), 6u);
  EXPECT_EQ(json["cases"][0]["amount"], -10);
  EXPECT_LT(std::abs(json["cases"][3]["offset_error_s"].get<double>()), 1e-7);
  EXPECT_EQ(json["cases"][5]["seed"], 2);
  EXPECT_THAT(read(out / "perturbation.csv"), HasSubstr("change of T_SC0.tx [m]"));
  EXPECT_EQ(contents(session()), before);
}

TEST(CommandPerturb, AStudyIsAFile) {
  const fs::path study = fs::path(::testing::TempDir()) / "command_perturb_study.yaml";
  write(study, "offsets-ms: [5, -5]\ndrop-frames-percent: 20\n");
  const fs::path out = freshFolder("command_perturb_study");
  const Outcome run = plumbline("perturb " + session().string() + " --study " + study.string() +
                                " --no-report --out " + out.string());
  ASSERT_EQ(run.exit_code, 0) << run.text;
  const auto json = nlohmann::json::parse(read(out / "perturbation.json"));
  EXPECT_EQ(json["cases"].size(), 3u);
}

TEST(CommandPerturb, BadUsageLeavesNothing) {
  const fs::path out = freshFolder("command_perturb_bad");
  for (const char* arguments :
       {"", "--offsets-ms abc", "--offsets-ms 1:0:2", "--drop-frames-percent 100",
        "--study no_such.yaml", "--corner-noise-px 1 --seed -1"}) {
    const Outcome run =
        plumbline("perturb " + session().string() + " " + arguments + " --out " + out.string());
    EXPECT_EQ(run.exit_code, 2) << arguments << "\n" << run.text;
    EXPECT_FALSE(fs::exists(out)) << arguments;
  }
}

TEST(CommandPerturb, AmountsAreRefusedInTheWordsOfWhoGaveThem) {
  const fs::path study = fs::path(::testing::TempDir()) / "command_perturb_words.yaml";
  write(study, "drop-frames-percent: [10, 100]\n");
  const fs::path out = freshFolder("command_perturb_words");
  const auto said = [&](const std::string& arguments) {
    const Outcome run =
        plumbline("perturb " + session().string() + " " + arguments + " --out " + out.string());
    EXPECT_EQ(run.exit_code, 2) << arguments << "\n" << run.text;
    return run.text;
  };
  // Two days: no clocks of one recording differ by as much.
  EXPECT_THAT(said("--offsets-ms 2e8"), HasSubstr("--offsets-ms 200000000: expected milliseconds"));
  EXPECT_THAT(said("--target-size-percent 1 --offsets-ms ''"),
              HasSubstr("--offsets-ms '': has an empty entry"));
  EXPECT_THAT(said("--offsets-ms 5,5"), HasSubstr("--offsets-ms: 5 is given twice"));
  EXPECT_THAT(said("--drop-imu-percent 100"), HasSubstr("--drop-imu-percent 100 %: expected"));
  EXPECT_THAT(said("--study " + study.string()),
              HasSubstr("command_perturb_words.yaml: drop-frames-percent 100 %: expected"));
  EXPECT_THAT(said("--offsets-ms 1 --no-imu"),
              HasSubstr("--offsets-ms changes what --no-imu leaves out"));
}

// A shift by which the IMU does not meet the frames any more: it was asked for, and needs no cure.
TEST(CommandPerturb, WhatWasInjectedHasNoCure) {
  const fs::path out = freshFolder("command_perturb_owners");
  const Outcome run =
      plumbline("perturb " + session().string() +
                " --offsets-ms 1e6 --models pinhole-radtan --no-report --out " + out.string());
  EXPECT_EQ(run.exit_code, 0) << run.text;
  EXPECT_THAT(run.text, Not(HasSubstr("--imu-shift-ms")));
  const auto json = nlohmann::json::parse(read(out / "perturbation.json"));
  for (const std::string& text : {json["cases"][0]["problem"].dump(), json["verdict"].dump()}) {
    EXPECT_THAT(text, HasSubstr("0 of 99 frame intervals"));
    EXPECT_THAT(text, Not(HasSubstr("--imu-shift-ms")));
  }
}

}  // namespace
}  // namespace plumbline
