// SPDX-License-Identifier: BSD-3-Clause
// What is no trajectory is refused by file and line, with the likely cause.
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

struct BadTrajectory {
  std::string name;
  std::string text;
  int line;  ///< expected; 0: the whole file
  InputFault code;
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
  } catch (const BadInput& error) {
    EXPECT_EQ(error.path(), path);
    EXPECT_EQ(error.line(), bad.line) << error.what();
    EXPECT_EQ(error.code(), bad.code) << error.what();
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

// Ten positions with two decimals in the last column, then that line.
std::string afterTenPositions(const std::string& last) {
  std::string text;
  for (int i = 0; i < 10; ++i) text += fmt::format("{0} 0.5 0.25 0.{0}5\n", i);
  return text + last;
}

std::string afterTen(const std::string& row, const std::string& last) {
  std::string text;
  for (int i = 0; i < 10; ++i) text += row;
  return text + last;
}

const std::string kGood = "1 0 0 0 0 0 0 1\n";
const std::string kNs = "#timestamp [ns], x, y, z, qw, qx, qy, qz\n";
const std::string kS = "# timestamp [s] x y z qx qy qz qw\n";

const std::vector<BadTrajectory> kCases = {
    {"Empty", "", 0, InputFault::kEmpty},
    {"OnlyComments", "# t x y z qx qy qz qw\n#\n", 0, InputFault::kEmpty},
    {"CutRow", kGood + "2 0 0 0 0 0", 2, InputFault::kTruncated},
    {"FewColumns", kGood + "2 0 0 0 0 0\n3 0 0 0 0 0 0 1\n", 2, InputFault::kBadColumns},
    {"OddColumns", "1 0 0 0 0 0 0 1 5\n", 1, InputFault::kBadColumns},
    {"ThreeColumns", "1 2 3\n", 1, InputFault::kBadColumns},
    {"ManyColumns",
     [] {
       std::string text = "1";
       for (int i = 0; i < 70; ++i) text += " 0";
       return text;
     }(),
     1, InputFault::kBadColumns},
    {"Word", kGood + "2 0 0 zero 0 0 0 1\n", 2, InputFault::kBadNumber},
    {"EmptyCell", commas(kGood) + "2,0,,0,0,0,0,1\n", 2, InputFault::kBadNumber},
    {"Nan", kGood + "2 nan 0 0 0 0 0 1\n", 2, InputFault::kNotFinite},
    {"NanQuaternion", kGood + "2 0 0 0 0 0 0 -nan\n", 2, InputFault::kNotFinite},
    {"Infinite", kGood + "2 inf 0 0 0 0 0 1\n", 2, InputFault::kNotFinite},
    {"NanStamp", kGood + "nan 0 0 0 0 0 0 1\n", 2, InputFault::kBadNumber},
    {"Overflow", kGood + "1e12 0 0 0 0 0 0 1\n", 2, InputFault::kBadNumber},
    {"ZeroQuaternion", kGood + "2 0 0 0 0 0 0 0\n", 2, InputFault::kNotRigid},
    {"LongQuaternion", kGood + "2 0 0 0 0 0 0 1.03\n", 2, InputFault::kNotRigid},
    {"ShortQuaternion", "1 0 0 0 0.1 0.2 0.3 0.4\n", 1, InputFault::kNotRigid},
    {"Unsorted", kGood + "3 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n", 3, InputFault::kBadOrder},
    {"ScalarFirst", "1 0 0 0 1 0 0 0\n2 1 0 0 0.99 0.1 0.1 0\n", 1, InputFault::kContradiction},
    {"ScalarLastInEuroc", "1403636579763555584,0,0,0,0,0,0,1\n", 1, InputFault::kContradiction},
    {"MillisecondsSince1970", rows("{:.3f}", 1403636579763.5, 50), 1, InputFault::kWrongUnit},
    {"MicrosecondsSince1970", rows("{:.1f}", 1403636579763555.0, 50000), 1, InputFault::kWrongUnit},
    {"HeaderSaysNanosecondsOfSeconds", kNs + commas(rows("{:.6f}", 1403636579.76, 0.05)), 2,
     InputFault::kWrongUnit},
    {"HeaderSaysSecondsOfNanoseconds", kS + rows("{:.0f}", 1.4036e18, 5e7), 2,
     InputFault::kWrongUnit},
    {"NanosecondsSinceStart", rows("{:.0f}", 0, 5e7), 1, InputFault::kWrongUnit},
    {"MillisecondsSinceStart", rows("{:.0f}", 0, 50), 1, InputFault::kWrongUnit},
    {"MicrosecondsSinceStart", rows("{:.0f}", 0, 50000), 1, InputFault::kWrongUnit},
    {"HeaderSaysSecondsOfNanosecondsSinceStart", kS + rows("{:.0f}", 0, 5e7), 2,
     InputFault::kWrongUnit},
    {"HeaderSaysNanosecondsMoreThanAnHourApart", kNs + commas(rows("{:.0f}", 0, 4e12)), 2,
     InputFault::kWrongUnit},
    {"SecondsAsNanoseconds", kNs + commas(rows("{:.6f}", 5, 0.05)), 2, InputFault::kWrongUnit},
    {"MillisecondsAsNanoseconds", kNs + commas(rows("{:.0f}", 5000, 50)), 2,
     InputFault::kWrongUnit},
    {"RarePosesWithoutAHeader", rows("{:.0f}", 0, 30), 1, InputFault::kWrongUnit},
    {"StampsWithoutDigits", rows("{:.3e}", 1403636579.76, 0.05), 1, InputFault::kWrongUnit},
    {"HeaderNamesColumnsThatAreNot", "# t a b c d e f g h px py pz\n1 2 3 4\n", 2,
     InputFault::kBadColumns},
    {"StampsSixHundredYearsApart", "-9000000000 0 0 0 0 0 0 1\n9000000000 0 0 0 0 0 0 1\n", 1,
     InputFault::kOutOfRange},
    {"ScaledByTwoPercent", "1.02 0 0 0 0 1.02 0 0 0 0 1.02 0\n", 1, InputFault::kNotRigid},
    {"NotARotation", "1 0 0 0 0 1 0 0 0 0 2 0\n", 1, InputFault::kNotRigid},
    {"Mirrored", "1 0 0 0 0 1 0 0 0 0 -1 0\n", 1, InputFault::kNotRigid},
    {"KittiNan", "1 0 0 0 0 1 0 nan 0 0 1 0\n", 1, InputFault::kNotFinite},
    {"LastNumberCut", afterTenPositions("10 0.5 0.25 0.9"), 11, InputFault::kTruncated},
    {"KittiNumberCut", afterTen("1 0 0 0.5 0 1 0 0.5 0 0 1 0.5\n", "1 0 0 0.5 0 1 0 0.5 0 0 1.0 0"),
     11, InputFault::kTruncated},
    {"KittiCut", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0", 2, InputFault::kTruncated},
    {"CovarianceNan", "1 0 0 0 0 0 0 1 nan 0 0 1 0 1 1 0 0 1 0 1\n", 1, InputFault::kNotFinite},
    {"MotiveWithoutColumns", "Format Version,1.23,Take Name,test\n\n1,2,3\n", 3,
     InputFault::kMissingKey},
};

INSTANTIATE_TEST_SUITE_P(Trajectories, Refused, testing::ValuesIn(kCases),
                         [](const auto& test) { return test.param.name; });

TEST(RefusedFiles, AreNamed) {
  const TemporaryFolder folder;
  EXPECT_EQ(faultOf([&] { readTrajectory(folder.path("none.txt")); }), InputFault::kMissingFile);
  EXPECT_EQ(faultOf([&] { readTrajectory(folder.path()); }), InputFault::kMissingFile);
}

TEST(RefusedFiles, OptionsOfOtherFormatsAreNotPassedOver) {
  const TemporaryFolder folder;
  const std::string poses = folder.write("poses.txt", kGood);
  TrajectoryReadOptions options;
  options.body = "nosuch";
  EXPECT_EQ(faultOf([&] { readTrajectory(poses, options); }), InputFault::kBadOption);
  options.body.clear();
  options.times = folder.write("times.txt", "0\n");
  EXPECT_EQ(faultOf([&] { readTrajectory(poses, options); }), InputFault::kBadOption);
}

// The unit named is the first in which poses come at a rate of poses, not merely below 20 s.
TEST(RefusedFiles, TheUnitIsThatOfAUsualRate) {
  const TemporaryFolder folder;
  const auto refusalAt = [&](double interval) {
    const std::string path = folder.write("poses.txt", rows("{:.0f}", 0, interval));
    return std::string(refusalOf([&] { readTrajectory(path); })->what());
  };
  EXPECT_THAT(refusalAt(50), testing::HasSubstr("look like milliseconds"));
  EXPECT_THAT(refusalAt(5e3), testing::HasSubstr("look like microseconds"));  // 5 ms, not 5 s
  EXPECT_THAT(refusalAt(5e6), testing::HasSubstr("look like nanoseconds"));
}

// Nanoseconds of a clock that counts from its own start, in a table of seconds: neither a time
// since 1970 in a coarser unit, nor a broken line where they overflow.
TEST(RefusedFiles, NanosecondsOfAnOwnClockAreNoOtherUnitSince1970) {
  const TemporaryFolder folder;
  for (const double from : {0.0, 1.5e9, 1e12, 2e15}) {
    const std::string path = folder.write("poses.txt", rows("{:.0f}", from, 5e7));
    const auto refusal = refusalOf([&] { readTrajectory(path); });
    ASSERT_TRUE(refusal) << from;
    EXPECT_THAT(refusal->what(), testing::HasSubstr("look like nanoseconds")) << from;
    EXPECT_EQ(refusal->line(), 1) << from;
  }
}

// Where the header states the unit, poses may be up to an hour apart, and no more.
TEST(RefusedFiles, StatedStampsMayBeAnHourApart) {
  const TemporaryFolder folder;
  const auto fault = [&](double interval_s) {
    const std::string path = folder.write("poses.txt", kS + rows("{:.0f}", 0, interval_s));
    return faultOf([&] { readTrajectory(path); });
  };
  EXPECT_EQ(fault(3600), std::nullopt);
  EXPECT_EQ(fault(3601), InputFault::kWrongUnit);
}

TEST(RefusedFiles, AFormatIsNamedWhereTheFirstRowIsNotOfIt) {
  const TemporaryFolder folder;
  TrajectoryReadOptions options;
  options.format = TrajectoryFormat::kKitti;
  const auto refusal =
      refusalOf([&] { readTrajectory(folder.write("poses.txt", kGood), options); });
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->what(), testing::HasSubstr("8 columns; expected 12, the 3x4 matrix"));
}

TEST(RefusedFiles, KittiTimesMustFit) {
  const TemporaryFolder folder;
  const std::string poses = folder.write("00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  TrajectoryReadOptions options;
  options.times = folder.write("times.txt", "0\n1\n");
  const auto refusal = refusalOf([&] { readTrajectory(poses, options); });
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->path(), options.times.string());
  EXPECT_EQ(refusal->code(), InputFault::kContradiction);
  options.times = folder.write("bad_times.txt", "0\nlater\n");
  EXPECT_EQ(faultOf([&] { readTrajectory(poses, options); }), InputFault::kBadNumber);
}

TEST(RefusedFiles, KittiTimesMustBeSeconds) {
  const TemporaryFolder folder;
  const std::string row = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const std::string poses = folder.write("00.txt", row + row + row);
  TrajectoryReadOptions options;
  options.times = folder.write("times.txt", "0\n100\n200\n");
  const auto refusal = refusalOf([&] { readTrajectory(poses, options); });
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->path(), options.times.string());
  EXPECT_EQ(refusal->code(), InputFault::kWrongUnit);
  EXPECT_THAT(refusal->what(), testing::HasSubstr("look like milliseconds"));
  EXPECT_THAT(refusal->what(), testing::HasSubstr("convert them to seconds"));
}

}  // namespace
}  // namespace plumbline
