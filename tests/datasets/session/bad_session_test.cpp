// SPDX-License-Identifier: BSD-3-Clause
// Each fault of a session is one InputError that names the file, the line and the cause.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/session/session_reader.h"
#include "tests/datasets/session/session_files.h"

namespace plumbline {
namespace {

struct BadFile {
  std::string name;  ///< of the case
  std::string file;  ///< replaced in a good session
  std::string text;
  int line;  ///< expected; 0: the whole file
  std::vector<std::string> words;
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
  } catch (const InputError& error) {
    EXPECT_EQ(error.path(), path);
    EXPECT_EQ(error.line(), bad.line) << error.what();
    for (const std::string& word : bad.words) EXPECT_THAT(error.what(), testing::HasSubstr(word));
  }
}

std::string corners(const std::string& rows) {
  return "#timestamp [ns],corner_id,u [px],v [px]\n" + rows;
}
std::string samples(const std::string& rows) {
  return "#timestamp [ns],wx,wy,wz,ax,ay,az\n" + rows;
}

const std::string kCorners = "cam1/corners.csv";
const std::vector<BadFile> kBadCorners = {
    {"Empty", kCorners, "", 0, {"is empty", "interrupted"}},
    {"HeaderOnly", kCorners, corners(""), 0, {"has no rows"}},
    {"CutRow", kCorners, corners("1000000000,0,1.5,2.5\n1000000000,1,3.5"), 3, {"cut", "v [px]"}},
    {"CutNumber",
     kCorners,
     corners("1000000000,0,1.52,2.51\n1000000000,1,3.12,4.5"),
     3,
     {"fewer decimals", "newline"}},
    {"FewColumns", kCorners, corners("1000000000,0,1.5\n1000000000,1,3,4\n"), 2, {"missing"}},
    {"ManyColumns", kCorners, corners("1000000000,0,1.5,2,9\n"), 2, {"more columns"}},
    {"Word", kCorners, corners("1000000000,0,left,2\n"), 2, {"u [px]", "left", "a number"}},
    {"NaN", kCorners, corners("1000000000,0,nan,2\n"), 2, {"nan", "finite"}},
    {"Infinity", kCorners, corners("1000000000,0,1,inf\n"), 2, {"inf", "finite"}},
    {"EmptyField", kCorners, corners("1000000000,0,,2\n"), 2, {"u [px]"}},
    {"FractionalId", kCorners, corners("1000000000,0.5,1,2\n"), 2, {"corner_id", "integer"}},
    {"IdAboveTarget", kCorners, corners("1000000000,144,1,2\n"), 2, {"144", "143", "target.yaml"}},
    {"NegativeId", kCorners, corners("1000000000,-1,1,2\n"), 2, {"-1"}},
    {"IdTwice", kCorners, corners("1000000000,3,1,2\n1000000000,3,1,2\n"), 3, {"given twice"}},
    {"OutsideImage", kCorners, corners("1000000000,0,752,2\n"), 2, {"752 x 480", "resolution"}},
    {"Backwards",
     kCorners,
     corners("2000000000,0,1,2\n1000000000,0,1,2\n"),
     3,
     {"earlier", "sort"}},
    {"FrameSplit",
     kCorners,
     corners("1000000000,0,1,2\n1050000000,0,1,2\n1000000000,1,1,2\n"),
     4,
     {"earlier"}},
    {"Seconds", kCorners, corners("1400.05,0,1,2\n"), 2, {"decimal point", "seconds"}},
    {"Microseconds",
     kCorners,
     corners("1000000,0,1,2\n1050000,0,1,2\n1100000,0,1,2\n"),
     0,
     {"microseconds"}},
    {"Milliseconds",
     kCorners,
     corners("1000,0,1,2\n1050,0,1,2\n1100,0,1,2\n"),
     0,
     {"milliseconds"}},
    {"StampTooLarge", kCorners, corners("99999999999999999999,0,1,2\n"), 2, {"timestamp"}},
};

const std::string kSamples = "imu0/data.csv";
const std::vector<BadFile> kBadSamples = {
    {"Empty", kSamples, "", 0, {"is empty"}},
    {"CutRow", kSamples, samples("1000000000,1,2,3,4,5,6\n1005000000,1,2"), 3, {"cut"}},
    {"FewColumns",
     kSamples,
     samples("1000000000,1,2,3,4,5\n1005000000,1,2,3,4,5\n"),
     2,
     {"missing"}},
    {"NaN", kSamples, samples("1000000000,1,2,3,4,nan,6\n"), 2, {"nan"}},
    {"StampTwice",
     kSamples,
     samples("1000000000,1,2,3,4,5,6\n1000000000,1,2,3,4,5,6\n"),
     3,
     {"twice"}},
    {"Backwards",
     kSamples,
     samples("1005000000,1,2,3,4,5,6\n1000000000,1,2,3,4,5,6\n"),
     3,
     {"earlier"}},
    {"Microseconds",
     kSamples,
     samples("1000000,1,2,3,4,5,6\n1005000,1,2,3,4,5,6\n1010000,1,2,3,4,5,6\n"),
     0,
     {"microseconds"}},
    {"Degrees",
     kSamples,
     "#t [ns],wx [deg/s],wy [deg/s],wz [deg/s],ax,ay,az\n1000000000,1,2,3,4,5,6\n",
     1,
     {"rad/s"}},
};

const std::string kTarget = "target.yaml";
const std::vector<BadFile> kBadTargets = {
    {"Checkerboard",
     kTarget,
     "target_type: checkerboard\ntargetRows: 6\n",
     1,
     {"checkerboard", "not supported"}},
    {"Circles", kTarget, "target_type: circlegrid\n", 1, {"circlegrid", "not supported"}},
    {"UnknownType", kTarget, "target_type: chessboard\n", 1, {"chessboard"}},
    {"Millimetres",
     kTarget,
     "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 88\ntagSpacing: 0.3\n",
     4,
     {"millimetres", "0.088"}},
    {"SpacingInMetres",
     kTarget,
     "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.0264\n",
     5,
     {"ratio", "0.3"}},
    {"NoSpacing",
     kTarget,
     "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0\n",
     5,
     {"ratio"}},
    {"MissingKey", kTarget, "target_type: aprilgrid\ntagCols: 6\ntagSize: 0.088\n", 1, {"tagRows"}},
    {"ZeroRows", kTarget, "target_type: aprilgrid\ntagRows: 0\ntagCols: 6\n", 2, {"tagRows"}},
    {"Syntax", kTarget, "target_type: aprilgrid\ntagCols: [6\ntagRows: 6\n", 3, {"YAML"}},
    {"KeyTwice", kTarget, "target_type: aprilgrid\ntagCols: 6\ntagCols: 7\n", 3, {"twice"}},
    {"NoMapping", kTarget, "just text\n", 0, {"mapping"}},
};

const std::string kImu = "imu.yaml";
const std::string kDensities =
    "update_rate: 200\naccelerometer_noise_density: 0.002\naccelerometer_random_walk: 0.003\n"
    "gyroscope_noise_density: 0.0001\n";
const std::vector<BadFile> kBadYamls = {
    {"ZeroDensity", kImu, kDensities + "gyroscope_random_walk: 0\n", 5, {"gyroscope_random_walk"}},
    {"NegativeDensity", kImu, kDensities + "gyroscope_random_walk: -1\n", 5, {"positive"}},
    {"MissingDensity", kImu, kDensities, 1, {"gyroscope_random_walk", "missing"}},
    {"ScaleMisalignment",
     kImu,
     "imu0:\n  model: scale-misalignment\n",
     2,
     {"misalignment", "not supported"}},
    {"SecondImu", kImu, "imu0:\n  model: calibrated\nimu1:\n  model: calibrated\n", 4, {"imu1"}},
    {"RollingShutter",
     "cam0/sensor.yaml",
     "resolution: [752, 480]\nline_delay: 1.0e-5\n",
     2,
     {"rolling shutter", "not supported"}},
    {"Omni",
     "cam0/sensor.yaml",
     "resolution: [752, 480]\ncamera_model: omni\ndistortion_model: radtan\n",
     2,
     {"omni-radtan", "not supported", "pinhole-equidistant"}},
    {"Fov",
     "cam0/sensor.yaml",
     "resolution: [752, 480]\ncamera_model: pinhole\ndistortion_model: fov\n",
     2,
     {"pinhole-fov"}},
    {"UnknownModel",
     "cam0/sensor.yaml",
     "resolution: [7, 4]\ncamera_model: pinhoel\n",
     2,
     {"pinhoel"}},
    {"NoResolution", "cam0/sensor.yaml", "camera_model: pinhole\n", 0, {"resolution", "WxH"}},
    {"BadResolution", "cam0/sensor.yaml", "resolution: [752]\n", 1, {"[width, height]"}},
};

const auto kCaseName = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(Corners, BadSession, testing::ValuesIn(kBadCorners), kCaseName);
INSTANTIATE_TEST_SUITE_P(Imu, BadSession, testing::ValuesIn(kBadSamples), kCaseName);
INSTANTIATE_TEST_SUITE_P(Target, BadSession, testing::ValuesIn(kBadTargets), kCaseName);
INSTANTIATE_TEST_SUITE_P(Yaml, BadSession, testing::ValuesIn(kBadYamls), kCaseName);

// ---- what is missing

std::string complaintWithout(const std::string& name) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  std::filesystem::remove_all(folder.path(name));
  try {
    readSession(folder.path());
    return "was accepted";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(MissingFile, IsNamedWithTheCure) {
  using testing::HasSubstr;
  EXPECT_THAT(complaintWithout("target.yaml"), HasSubstr("target.yaml: does not exist"));
  EXPECT_THAT(complaintWithout("imu.yaml"), HasSubstr("imu.yaml: does not exist"));
  EXPECT_THAT(complaintWithout("imu0/data.csv"), HasSubstr("imu0/data.csv: cannot be read"));
  EXPECT_THAT(complaintWithout("cam1/corners.csv"), HasSubstr("neither corners nor images"));
  EXPECT_THAT(complaintWithout("cam0/sensor.yaml"), HasSubstr("--resolution"));
  EXPECT_THAT(complaintWithout(""), HasSubstr("does not exist; expected a EuRoC ASL folder"));
}

}  // namespace
}  // namespace plumbline
