// SPDX-License-Identifier: BSD-3-Clause
// What is no trajectory is refused by file and line, with the likely cause.
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

struct BadTrajectory {
  std::string name;
  std::string text;
  int line;  ///< expected; 0: the whole file
  std::vector<std::string> words;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest looks for this name
void PrintTo(const BadTrajectory& bad, std::ostream* out) { *out << bad.name; }

class Refused : public testing::TestWithParam<BadTrajectory> {};

TEST_P(Refused, ByFileLineAndCause) {
  const TemporaryFolder folder;
  const BadTrajectory& bad = GetParam();
  const std::string path = folder.write("bad.txt", bad.text);
  try {
    readTrajectory(path);
    FAIL() << "was accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.path(), path);
    EXPECT_EQ(error.line(), bad.line) << error.what();
    for (const std::string& word : bad.words) EXPECT_THAT(error.what(), testing::HasSubstr(word));
  }
}

// Rows at `from`, `from + step`, ... in whatever unit.
std::string rows(const std::string& form, double from, double step) {
  std::string text;
  for (int i = 0; i < 5; ++i) {
    text += fmt::format(fmt::runtime(form), from + step * i) + " 0 0 0 0 0 0 1\n";
  }
  return text;
}

std::string commas(std::string text) {
  for (char& c : text) c = c == ' ' ? ',' : c;
  return text;
}

const std::string kGood = "1 0 0 0 0 0 0 1\n";
const std::string kNs = "#timestamp [ns], x, y, z, qw, qx, qy, qz\n";
const std::string kS = "# timestamp [s] x y z qx qy qz qw\n";

const std::vector<BadTrajectory> kCases = {
    {"Empty", "", 0, {"is empty", "interrupted"}},
    {"OnlyComments", "# t x y z qx qy qz qw\n#\n", 0, {"has no poses"}},
    {"CutRow", kGood + "2 0 0 0 0 0", 2, {"6 columns", "8", "truncated"}},
    {"FewColumns", kGood + "2 0 0 0 0 0\n3 0 0 0 0 0 0 1\n", 2, {"6 columns", "repair"}},
    {"OddColumns", "1 0 0 0 0 0 0 1 5\n", 1, {"9 columns", "name the columns"}},
    {"ThreeColumns", "1 2 3\n", 1, {"3 columns"}},
    {"ManyColumns",
     [] {
       std::string text = "1";
       for (int i = 0; i < 70; ++i) text += " 0";
       return text;
     }(),
     1,
     {"64 columns", "right file"}},
    {"Word", kGood + "2 0 0 zero 0 0 0 1\n", 2, {"column 4 is 'zero'", "a number"}},
    {"EmptyCell", commas(kGood) + "2,0,,0,0,0,0,1\n", 2, {"column 3 is ''"}},
    {"Nan", kGood + "2 nan 0 0 0 0 0 1\n", 2, {"not finite", "diverged"}},
    {"NanQuaternion", kGood + "2 0 0 0 0 0 0 -nan\n", 2, {"not finite"}},
    {"Infinite", kGood + "2 inf 0 0 0 0 0 1\n", 2, {"not finite"}},
    {"NanStamp", kGood + "nan 0 0 0 0 0 0 1\n", 2, {"the stamp 'nan'"}},
    {"Overflow", kGood + "1e12 0 0 0 0 0 0 1\n", 2, {"the stamp '1e12'", "292 years"}},
    {"ZeroQuaternion", kGood + "2 0 0 0 0 0 0 0\n", 2, {"all zeros", "no orientation"}},
    {"LongQuaternion", kGood + "2 0 0 0 0 0 0 1.03\n", 2, {"1.03", "another order", "Euler"}},
    {"ShortQuaternion", "1 0 0 0 0.1 0.2 0.3 0.4\n", 1, {"length is 0.547"}},
    {"Unsorted",
     kGood + "3 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n",
     3,
     {"1.000000000 s before", "sort", "two runs"}},
    {"ScalarFirst",
     "1 0 0 0 1 0 0 0\n2 1 0 0 0.99 0.1 0.1 0\n",
     1,
     {"look like w x y z", "half a turn", "qw qx qy qz"}},
    {"ScalarLastInEuroc", "1403636579763555584,0,0,0,0,0,0,1\n", 1, {"look like x y z w"}},
    {"MillisecondsSince1970",
     rows("{:.3f}", 1403636579763.5, 50),
     1,
     {"looks like milliseconds since 1970", "[ms]"}},
    {"MicrosecondsSince1970",
     rows("{:.1f}", 1403636579763555.0, 50000),
     1,
     {"looks like microseconds since 1970", "[us]"}},
    {"HeaderSaysNanosecondsOfSeconds",
     kNs + commas(rows("{:.6f}", 1403636579.76, 0.05)),
     2,
     {"looks like seconds", "as the header states"}},
    {"HeaderSaysSecondsOfNanoseconds",
     kS + rows("{:.0f}", 1.4036e18, 5e7),
     2,
     {"looks like nanoseconds", "as the header states"}},
    {"NanosecondsSinceStart", rows("{:.0f}", 0, 5e7), 1, {"look like nanoseconds", "[ns]"}},
    {"MillisecondsSinceStart", rows("{:.0f}", 0, 50), 1, {"look like milliseconds", "[ms]"}},
    {"MicrosecondsSinceStart", rows("{:.0f}", 0, 50000), 1, {"look like microseconds", "[us]"}},
    {"SecondsAsNanoseconds", kNs + commas(rows("{:.6f}", 5, 0.05)), 2, {"look like seconds"}},
    {"MillisecondsAsNanoseconds",
     kNs + commas(rows("{:.0f}", 5000, 50)),
     2,
     {"look like milliseconds"}},
    {"StampsWithoutDigits",
     rows("{:.3e}", 1403636579.76, 0.05),
     1,
     {"equal to the one before", "lost their digits"}},
    {"NotARotation", "1 0 0 0 0 1 0 0 0 0 2 0\n", 1, {"no rotation", "row by row"}},
    {"Mirrored", "1 0 0 0 0 1 0 0 0 0 -1 0\n", 1, {"no rotation"}},
    {"KittiNan", "1 0 0 0 0 1 0 nan 0 0 1 0\n", 1, {"not finite"}},
    {"KittiCut", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0", 2, {"3 columns", "truncated"}},
    {"CovarianceNan", "1 0 0 0 0 0 0 1 nan 0 0 1 0 1 1 0 0 1 0 1\n", 1, {"covariance"}},
    {"MotiveWithoutColumns",
     "Format Version,1.23,Take Name,test\n\n1,2,3\n",
     3,
     {"'Frame,Time (Seconds),...'"}},
};

INSTANTIATE_TEST_SUITE_P(Trajectories, Refused, testing::ValuesIn(kCases),
                         [](const auto& test) { return test.param.name; });

TEST(RefusedFiles, AreNamed) {
  const TemporaryFolder folder;
  EXPECT_THROW(readTrajectory(folder.path("none.txt")), InputError);
  EXPECT_THROW(readTrajectory(folder.path()), InputError);
}

TEST(RefusedFiles, KittiTimesMustFit) {
  const TemporaryFolder folder;
  const std::string poses = folder.write("00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  TrajectoryReadOptions options;
  options.times = folder.write("times.txt", "0\n1\n");
  try {
    readTrajectory(poses, options);
    FAIL() << "was accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.path(), options.times.string());
    EXPECT_THAT(error.what(), testing::HasSubstr("has 2 stamps for the 1 poses"));
  }
  options.times = folder.write("bad_times.txt", "0\nlater\n");
  EXPECT_THROW(readTrajectory(poses, options), InputError);
}

}  // namespace
}  // namespace plumbline
