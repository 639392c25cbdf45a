// SPDX-License-Identifier: BSD-3-Clause
// Each fault of a session is one InputError that names the file, the line and the cause.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/target.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/session/session_files.h"

namespace plumbline {
namespace {

struct BadFile {
  std::string name;  ///< of the case
  std::string file;  ///< replaced in a good session
  std::string text;
  int line;  ///< expected; 0: the whole file
  InputFault code;
};

void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.name; }

class BadSession : public testing::TestWithParam<BadFile> {};

TEST_P(BadSession, IsRefusedByFileAndLine) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  const BadFile& bad = GetParam();
  const std::string path = folder.write(bad.file, bad.text);
  try {
    readSession(folder.path());
    FAIL() << "was accepted";
  } catch (const BadInput& error) {
    EXPECT_EQ(error.path(), path);
    EXPECT_EQ(error.line(), bad.line) << error.what();
    EXPECT_EQ(error.code(), bad.code) << error.what();
  }
}

std::string corners(const std::string& rows) {
  return "#timestamp [ns],corner_id,u [px],v [px]\n" + rows;
}
std::string samples(const std::string& rows) {
  return "#timestamp [ns],wx,wy,wz,ax,ay,az\n" + rows;
}

// Ten corners with two decimals, then that line.
std::string afterTenCorners(const std::string& last) {
  std::string rows;
  for (int id = 0; id < 10; ++id) rows += "1000000000," + std::to_string(id) + ",1.52,2.51\n";
  return corners(rows + last);
}

const std::string kCorners = "cam1/corners.csv";
const std::vector<BadFile> kBadCorners = {
    {"Empty", kCorners, "", 0, InputFault::kEmpty},
    {"HeaderOnly", kCorners, corners(""), 0, InputFault::kEmpty},
    {"CutRow", kCorners, corners("1000000000,0,1.5,2.5\n1000000000,1,3.5"), 3,
     InputFault::kTruncated},
    {"CutNumber", kCorners, afterTenCorners("1000000000,10,3.12,4.5"), 12, InputFault::kTruncated},
    {"FewColumns", kCorners, corners("1000000000,0,1.5\n1000000000,1,3,4\n"), 2,
     InputFault::kBadColumns},
    {"ManyColumns", kCorners, corners("1000000000,0,1.5,2,9\n"), 2, InputFault::kBadColumns},
    {"Word", kCorners, corners("1000000000,0,left,2\n"), 2, InputFault::kBadNumber},
    {"NaN", kCorners, corners("1000000000,0,nan,2\n"), 2, InputFault::kNotFinite},
    {"Infinity", kCorners, corners("1000000000,0,1,inf\n"), 2, InputFault::kNotFinite},
    {"EmptyField", kCorners, corners("1000000000,0,,2\n"), 2, InputFault::kBadNumber},
    {"FractionalId", kCorners, corners("1000000000,0.5,1,2\n"), 2, InputFault::kBadNumber},
    {"IdAboveTarget", kCorners, corners("1000000000,144,1,2\n"), 2, InputFault::kOutOfRange},
    {"NegativeId", kCorners, corners("1000000000,-1,1,2\n"), 2, InputFault::kOutOfRange},
    {"IdTwice", kCorners, corners("1000000000,3,1,2\n1000000000,3,1,2\n"), 3,
     InputFault::kDuplicate},
    // Pixels reach half a pixel around their centres; the image is 752 x 480.
    {"RightOfImage", kCorners, corners("1000000000,0,751.5,2\n1000000000,1,751.51,2\n"), 3,
     InputFault::kOutOfRange},
    {"LeftOfImage", kCorners, corners("1000000000,0,-0.5,2\n1000000000,1,-0.51,2\n"), 3,
     InputFault::kOutOfRange},
    {"BelowImage", kCorners, corners("1000000000,0,2,479.5\n1000000000,1,2,479.51\n"), 3,
     InputFault::kOutOfRange},
    {"AboveImage", kCorners, corners("1000000000,0,2,-0.5\n1000000000,1,2,-0.51\n"), 3,
     InputFault::kOutOfRange},
    {"Backwards", kCorners, corners("2000000000,0,1,2\n1000000000,0,1,2\n"), 3,
     InputFault::kBadOrder},
    {"FrameSplit", kCorners, corners("1000000000,0,1,2\n1050000000,0,1,2\n1000000000,1,1,2\n"), 4,
     InputFault::kBadOrder},
    {"Semicolons", kCorners, corners("1000000000;0;1.5;2.5\n"), 2, InputFault::kBadColumns},
    {"Seconds", kCorners, corners("1400.05,0,1,2\n"), 2, InputFault::kWrongUnit},
    {"Microseconds", kCorners, corners("1000000,0,1,2\n1050000,0,1,2\n1100000,0,1,2\n"), 0,
     InputFault::kWrongUnit},
    {"Milliseconds", kCorners, corners("1000,0,1,2\n1050,0,1,2\n1100,0,1,2\n"), 0,
     InputFault::kWrongUnit},
    {"StampTooLarge", kCorners, corners("99999999999999999999,0,1,2\n"), 2, InputFault::kBadNumber},
};

const std::string kSamples = "imu0/data.csv";
const std::vector<BadFile> kBadSamples = {
    {"Empty", kSamples, "", 0, InputFault::kEmpty},
    {"CutRow", kSamples, samples("1000000000,1,2,3,4,5,6\n1005000000,1,2"), 3,
     InputFault::kTruncated},
    {"FewColumns", kSamples, samples("1000000000,1,2,3,4,5\n1005000000,1,2,3,4,5\n"), 2,
     InputFault::kBadColumns},
    {"NaN", kSamples, samples("1000000000,1,2,3,4,nan,6\n"), 2, InputFault::kNotFinite},
    {"StampTwice", kSamples, samples("1000000000,1,2,3,4,5,6\n1000000000,1,2,3,4,5,6\n"), 3,
     InputFault::kBadOrder},
    {"Backwards", kSamples, samples("1005000000,1,2,3,4,5,6\n1000000000,1,2,3,4,5,6\n"), 3,
     InputFault::kBadOrder},
    {"Microseconds", kSamples,
     samples("1000000,1,2,3,4,5,6\n1005000,1,2,3,4,5,6\n1010000,1,2,3,4,5,6\n"), 0,
     InputFault::kWrongUnit},
    {"Degrees", kSamples,
     "#t [ns],wx [deg/s],wy [deg/s],wz [deg/s],ax,ay,az\n1000000000,1,2,3,4,5,6\n", 1,
     InputFault::kWrongUnit},
    {"Gravities", kSamples, "#t [ns],wx,wy,wz,ax [g],ay [g],az [g]\n1000000000,1,2,3,0,0,1\n", 1,
     InputFault::kWrongUnit},
    {"DegreesInALineThatEndsInAComma", kSamples,
     "#t [ns],wx [deg/s],wy [deg/s],wz [deg/s],ax,ay,az,\n1000000000,1,2,3,4,5,6,\n", 1,
     InputFault::kWrongUnit},
    {"DegreesInTheSecondLine", kSamples,
     "# by a logger\n#t [ns],wx [deg/s],wy [deg/s],wz [deg/s],ax,ay,az\n1000000000,1,2,3,4,5,6\n",
     2, InputFault::kWrongUnit},
};

const std::string kTarget = "target.yaml";
const std::vector<BadFile> kBadTargets = {
    {"Checkerboard", kTarget, "target_type: checkerboard\ntargetRows: 6\n", 1,
     InputFault::kUnsupported},
    {"Circles", kTarget, "target_type: circlegrid\n", 1, InputFault::kUnsupported},
    {"UnknownType", kTarget, "target_type: chessboard\n", 1, InputFault::kUnknownWord},
    {"Millimetres", kTarget,
     "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 88\ntagSpacing: 0.3\n", 4,
     InputFault::kOutOfRange},
    {"SpacingInMetres", kTarget,
     "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.0264\n", 5,
     InputFault::kOutOfRange},
    {"NoSpacing", kTarget,
     "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0\n", 5,
     InputFault::kOutOfRange},
    {"MoreTagsThanTheFamily", kTarget,
     "target_type: aprilgrid\ntagRows: 4\ntagCols: 147\ntagSize: 0.05\ntagSpacing: 0.3\n", 2,
     InputFault::kOutOfRange},
    {"MissingKey", kTarget, "target_type: aprilgrid\ntagCols: 6\ntagSize: 0.088\n", 1,
     InputFault::kMissingKey},
    {"ZeroRows", kTarget, "target_type: aprilgrid\ntagRows: 0\ntagCols: 6\n", 2,
     InputFault::kOutOfRange},
    {"Syntax", kTarget, "target_type: aprilgrid\ntagCols: [6\ntagRows: 6\n", 3,
     InputFault::kSyntax},
    {"KeyTwice", kTarget, "target_type: aprilgrid\ntagCols: 6\ntagCols: 7\n", 3,
     InputFault::kDuplicate},
    {"NoMapping", kTarget, "just text\n", 0, InputFault::kUnknownFile},
};

const std::string kImu = "imu.yaml";
const std::string kDensities =
    "update_rate: 200\naccelerometer_noise_density: 0.002\naccelerometer_random_walk: 0.003\n"
    "gyroscope_noise_density: 0.0001\n";
const std::vector<BadFile> kBadYamls = {
    {"ZeroDensity", kImu, kDensities + "gyroscope_random_walk: 0\n", 5, InputFault::kOutOfRange},
    {"NegativeDensity", kImu, kDensities + "gyroscope_random_walk: -1\n", 5,
     InputFault::kOutOfRange},
    {"MissingDensity", kImu, kDensities, 1, InputFault::kMissingKey},
    {"ScaleMisalignment", kImu, "imu0:\n  model: scale-misalignment\n", 2,
     InputFault::kUnsupported},
    {"SecondImu", kImu, "imu0:\n  model: calibrated\nimu1:\n  model: calibrated\n", 4,
     InputFault::kUnsupported},
    {"RollingShutter", "cam0/sensor.yaml", "resolution: [752, 480]\nline_delay: 1.0e-5\n", 2,
     InputFault::kUnsupported},
    {"Omni", "cam0/sensor.yaml",
     "resolution: [752, 480]\ncamera_model: omni\ndistortion_model: fov\n", 2,
     InputFault::kUnsupportedModel},
    {"Fov", "cam0/sensor.yaml", "resolution: [752, 480]\ncamera_model: ds\ndistortion_model: fov\n",
     2, InputFault::kUnsupportedModel},
    {"UnknownModel", "cam0/sensor.yaml", "resolution: [7, 4]\ncamera_model: pinhoel\n", 2,
     InputFault::kUnknownWord},
    {"NoResolution", "cam0/sensor.yaml", "camera_model: pinhole\n", 0, InputFault::kNoResolution},
    {"BadResolution", "cam0/sensor.yaml", "resolution: [752]\n", 1, InputFault::kBadNumber},
};

// Beside corners no image proves a name of the list: a copy that was cut is told by its last line.
const std::string kList = "cam1/data.csv";
std::string frames(const std::string& rows) { return "#timestamp [ns],filename\n" + rows; }
const std::vector<BadFile> kBadLists = {
    {"CutName", kList, frames("1400000000000000000,1.png\n1400000000050000000,2.pn"), 3,
     InputFault::kTruncated},
    {"CutBeforeName", kList, frames("1400000000000000000,1.png\n1400000000050000000"), 3,
     InputFault::kTruncated},
    {"CutStamp", kList, frames("1400000000000000000,1.png\n14000000000500"), 3,
     InputFault::kTruncated},
    {"CutInTheOnlyRow", kList, frames("14000000000500"), 2, InputFault::kTruncated},
    {"CutNameOfAnotherFormat", kList, frames("1400000000000000000,1.pgm\n1400000000050000000,2.pg"),
     3, InputFault::kTruncated},
    {"CutNameWithoutEnding", kList, frames("1400000000000000000,f_1\n1400000000050000000,f"), 3,
     InputFault::kTruncated},
    {"NameMissing", kList, frames("1400000000000000000,1.png\n1400000000050000000\n"), 3,
     InputFault::kBadColumns},
};

const auto kCaseName = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(Corners, BadSession, testing::ValuesIn(kBadCorners), kCaseName);
INSTANTIATE_TEST_SUITE_P(Imu, BadSession, testing::ValuesIn(kBadSamples), kCaseName);
INSTANTIATE_TEST_SUITE_P(Target, BadSession, testing::ValuesIn(kBadTargets), kCaseName);
INSTANTIATE_TEST_SUITE_P(List, BadSession, testing::ValuesIn(kBadLists), kCaseName);
INSTANTIATE_TEST_SUITE_P(Yaml, BadSession, testing::ValuesIn(kBadYamls), kCaseName);

TEST(TargetFile, ATagTooLargeMayBeInMillimetresOrCentimetres) {
  const TemporaryFolder folder;
  std::string text = kTargetText;
  text.replace(text.find("0.088"), 5, "8.8");
  const auto refusal = refusalOf([&] { readTarget(folder.write("target.yaml", text)); });
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->what(),
              testing::HasSubstr("tagSize: 0.0088 if it is in millimetres, 0.088 if in centi"));
}

// 26.4 mm between tags of 88 mm are 0.3 of their size.
TEST(TargetFile, ASpacingInMetresBecomesARatio) {
  const TemporaryFolder folder;
  std::string text = kTargetText;
  text.replace(text.find("0.3\n"), 3, "0.0264");
  const auto refusal = refusalOf([&] { readTarget(folder.write("target.yaml", text)); });
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->what(), testing::HasSubstr("write tagSpacing: 0.3"));
}

// tag36h11 has 587 tags.
TEST(TargetFile, AGridMayUseTheWholeFamily) {
  const TemporaryFolder folder;
  const auto fault = [&](const std::string& cols) {
    std::string text = kTargetText;
    text.replace(text.find("tagCols: 6"), 10, "tagCols: " + cols);
    text.replace(text.find("tagRows: 6"), 10, "tagRows: 1");
    return faultOf([&] { readTarget(folder.write("target.yaml", text)); });
  };
  EXPECT_EQ(fault("587"), std::nullopt);
  EXPECT_EQ(fault("588"), InputFault::kOutOfRange);
}

// ---- stamps

// Seconds, and nanoseconds that went through a table of floating-point numbers.
TEST(StampUnit, ADecimalPointIsNotAlwaysOfSeconds) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  for (const auto& [stamp, cure] :
       {std::pair{"1400000000.05", "multiplied by 1e9"}, std::pair{"1.40000000005e9", "multiplied"},
        std::pair{"1400000000050000000.0", "all digits"}, std::pair{"1.4e+18", "all digits"}}) {
    folder.write(kSamples, samples(std::string(stamp) + ",0,0,0,0,0,9.8\n"));
    const auto refusal = refusalOf([&] { readSession(folder.path()); });
    ASSERT_TRUE(refusal);
    EXPECT_THAT(refusal->what(), testing::HasSubstr(cure)) << stamp;
  }
}

// Samples at 200 Hz: 5 ms are 5000 us.
TEST(StampUnit, IsNamedByTheRateThatItWouldGive) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  for (const auto& [step, unit] : {std::pair{5000, "microseconds"}, std::pair{5, "milliseconds"}}) {
    std::string rows;
    for (int i = 0; i < 4; ++i) rows += std::to_string(100 + i * step) + ",0,0,0,0,0,9.8\n";
    folder.write(kSamples, samples(rows));
    const auto refusal = refusalOf([&] { readSession(folder.path()); });
    ASSERT_TRUE(refusal);
    EXPECT_THAT(refusal->what(), testing::HasSubstr(std::string("look like ") + unit));
  }
}

// A driver that stamps what it finds in its buffer gives most samples nearly the stamp of the one
// before; on the whole they come at 200 Hz.
TEST(StampUnit, BurstsAreNoOtherUnit) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  std::string rows;
  for (int burst = 0; burst < 4; ++burst) {
    for (int i = 0; i < 4; ++i) {
      rows += std::to_string(1'000'000'000 + burst * 20'000'000 + i * 1000) + ",0,0,0,0,0,9.8\n";
    }
  }
  folder.write(kSamples, samples(rows));
  EXPECT_EQ(readSession(folder.path()).imu->samples.size(), 16U);
}

// ---- what is missing

// What a session without this file or folder is refused for.
std::string refusalWithout(const std::string& name, InputFault code) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  std::filesystem::remove_all(folder.path(name));
  const auto refusal = refusalOf([&] { readSession(folder.path()); });
  if (!refusal) return "was accepted";
  EXPECT_EQ(refusal->code(), code) << refusal->what();
  return std::filesystem::path(refusal->path()).lexically_relative(folder.path()).string();
}

TEST(MissingFile, IsNamed) {
  EXPECT_EQ(refusalWithout("target.yaml", InputFault::kNoTarget), "target.yaml");
  EXPECT_EQ(refusalWithout("imu.yaml", InputFault::kNoImuNoise), "imu.yaml");
  EXPECT_EQ(refusalWithout("imu0/data.csv", InputFault::kMissingFile), "imu0/data.csv");
  EXPECT_EQ(refusalWithout("imu0", InputFault::kNoImuSamples), "imu0/data.csv");
  EXPECT_EQ(refusalWithout("cam1/corners.csv", InputFault::kEmpty), "cam1");
  EXPECT_EQ(refusalWithout("cam0/sensor.yaml", InputFault::kNoResolution), "cam0/sensor.yaml");
  EXPECT_EQ(refusalWithout("", InputFault::kMissingFile), ".");
}

}  // namespace
}  // namespace plumbline
