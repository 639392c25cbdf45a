// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/command_tree.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

TEST(EditDistance, CountsEdits) {
  EXPECT_EQ(editDistance("", ""), 0);
  EXPECT_EQ(editDistance("out", ""), 3);
  EXPECT_EQ(editDistance("--out", "--ot"), 1);
  EXPECT_EQ(editDistance("--out", "--oat"), 1);
  EXPECT_EQ(editDistance("compare", "compaer"), 1);  // two neighbours swapped
  EXPECT_EQ(editDistance("kitten", "sitting"), 3);
}

TEST(EditDistance, IsSymmetric) {
  for (const char* a : {"--models", "--loss", "", "replay"}) {
    for (const char* b : {"--model", "--less", "report", "a"}) {
      EXPECT_EQ(editDistance(a, b), editDistance(b, a)) << a << ' ' << b;
    }
  }
}

TEST(NearestWord, IsWithinAThirdOfTheLetters) {
  const std::vector<std::string> commands{"calibrate", "compare", "replay", "report"};
  EXPECT_EQ(nearestWord("calibrat", commands), "calibrate");
  EXPECT_EQ(nearestWord("compair", commands), "compare");
  EXPECT_EQ(nearestWord("relpay", commands), "replay");
  EXPECT_EQ(nearestWord("session", commands), "");
  EXPECT_EQ(nearestWord("x", {}), "");
}

TEST(UsageText, SaysWhatTheOptionExpects) {
  CLI::App app;
  int rows = 0;
  double shift = 0;
  std::string out;
  bool joint = false;
  app.add_option("--rows", rows);
  app.add_option("--shift", shift);
  app.add_option("--out", out);
  app.add_flag("--joint", joint);
  const auto said = [&](std::vector<std::string> arguments) -> std::string {
    std::reverse(arguments.begin(), arguments.end());
    try {
      app.parse(arguments);
    } catch (const CLI::ParseError& error) {
      return usageText(error, app);
    }
    return "";
  };
  EXPECT_EQ(said({"--out", "a", "--out", "b"}), "--out is given 2 times; expected once");
  EXPECT_EQ(said({"--out"}), "--out: expected a value");
  EXPECT_EQ(said({"--rows", "1.5"}), "--rows: 1.5: expected a whole number below 2147483648");
  EXPECT_EQ(said({"--shift", "1,5"}), "--shift: 1,5: expected a number");
  EXPECT_EQ(said({"--joint=abc"}), "--joint: abc: expected no value");
  EXPECT_EQ(said({"--rows", "3"}), "");
}

TEST(Owners, AnOptionOfCalibrateThatAnotherCommandLacksIsSaidToBeCalibrates) {
  CLI::App app;
  CLI::App* calibrate = app.add_subcommand("calibrate");
  calibrate->add_option("--models");
  calibrate->add_flag("--no-imu");
  CLI::App* score = app.add_subcommand("evaluate")->add_subcommand("calibration");
  score->add_flag("--no-imu");
  const std::string text = "try --models auto (--models), or --no-imu; --unknown stays";
  EXPECT_EQ(withOwners(text, *calibrate), text);
  EXPECT_EQ(withOwners(text, *score),
            "try calibrate's --models auto (calibrate's --models), or --no-imu; --unknown stays");
  EXPECT_EQ(withOwners("", *score), "");
}

// Options of a study's file, which are refused in the words of the command line.
TEST(ParseReversed, SaysWhatIsNoNumberInOurWords) {
  CLI::App app;
  double shift = 0;
  app.add_option("--shift", shift);
  const auto said = [&](std::vector<std::string> words) -> std::string {
    try {
      parseReversed(app, "calibrate", std::move(words));
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(said({"2", "--shift"}), "");
  EXPECT_EQ(said({"two", "--shift"}), "plumbline calibrate: --shift: two: expected a number");
}

}  // namespace
}  // namespace plumbline
