// SPDX-License-Identifier: BSD-3-Clause
// What our calibration.json says beside the calibration: covariances and deviations of its stages.
#include <cmath>
#include <map>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/calibration/calibration_reader.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

// Two parameters of a stage with variances 4 and 9; `first` is one of the camera's or of the rig's.
std::string covariance(const std::string& first) {
  return fmt::format(
      R"({{"parameters": [{{"name": "{}", "unit": "px"}}, {{"name": "T_SC0.tx", "unit": "m"}}],
 "matrix": [[4, 1], [1, 9]]}})",
      first);
}

std::string file(const std::string& camera_imu, const std::string& robust) {
  return fmt::format(
      R"({{"schema": 1, "cameras": [],
"stages": {{"camera": {{}}, "camera_imu": {{{}}}}},
"covariance": {{
 "camera": {{"parameters": [{{"name": "cam0.fu", "unit": "px"}}], "matrix": [[0.25]]}},
 "camera_imu": {}}}}})",
      robust, camera_imu);
}

class Deviations : public testing::Test {
 protected:
  std::string write(const std::string& text) const { return folder_.write("rig.json", text); }
  TemporaryFolder folder_;
};

/// Without their degrees of freedom.
std::map<std::string, double> deviationsOf(const std::string& path) {
  std::map<std::string, double> out;
  for (const auto& [name, of] : CalibrationFile(path).deviations()) out[name] = of.std;
  return out;
}

TEST_F(Deviations, AreRootsOfTheVariances) {
  EXPECT_THAT(deviationsOf(write(file(covariance("T_SC0.ty"), ""))),
              ElementsAre(Pair("T_SC0.tx", 3), Pair("T_SC0.ty", 2), Pair("cam0.fu", 0.5)));
}

TEST_F(Deviations, AreRobustWhereTheStageHasThem) {
  EXPECT_THAT(deviationsOf(write(file(covariance("T_SC0.ty"), R"("robust_std": [5, 7])"))),
              ElementsAre(Pair("T_SC0.tx", 7), Pair("T_SC0.ty", 5), Pair("cam0.fu", 0.5)));
}

// Formal ones are taken for known, and so are robust ones without degrees of freedom.
TEST_F(Deviations, HaveTheDegreesOfFreedomOfRobustOnes) {
  const auto both = CalibrationFile(write(file(covariance("T_SC0.ty"),
                                               R"("robust_std": [5, 7], "robust_dof": [4.5, 9])")))
                        .deviations();
  EXPECT_EQ(both.at("T_SC0.ty").dof, 4.5);
  EXPECT_EQ(both.at("T_SC0.tx").dof, 9);
  EXPECT_TRUE(std::isinf(both.at("cam0.fu").dof));
  const auto without =
      CalibrationFile(write(file(covariance("T_SC0.ty"), R"("robust_std": [5, 7])"))).deviations();
  EXPECT_TRUE(std::isinf(without.at("T_SC0.ty").dof));
}

// A null stands for what is not finite.
TEST_F(Deviations, OfNullDegreesOfFreedomAreTakenForKnown) {
  const auto stated =
      CalibrationFile(
          write(file(covariance("T_SC0.ty"), R"("robust_std": [5, 7], "robust_dof": [null, 9])")))
          .deviations();
  EXPECT_TRUE(std::isinf(stated.at("T_SC0.ty").dof));
  EXPECT_EQ(stated.at("T_SC0.ty").std, 5);
}

/// A stage of T_SC0, the time offset and `further`, whose variances are 0 but the first, 4.
std::string imuCovariance(const std::vector<std::string>& further = {}) {
  std::vector<std::string> names{"tx", "ty", "tz", "rx", "ry", "rz", "offset"};
  names.insert(names.end(), further.begin(), further.end());
  std::vector<std::string> parameters, rows;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<int> row(names.size(), 0);
    if (i == 0) row[0] = 4;
    parameters.push_back(fmt::format(R"({{"name": "{}", "unit": "m"}})", names[i]));
    rows.push_back(fmt::format("[{}]", fmt::join(row, ", ")));
  }
  return fmt::format(R"({{"parameters": [{}], "matrix": [{}]}})", fmt::join(parameters, ", "),
                     fmt::join(rows, ", "));
}

// Cameras that trigger apart have time offsets behind T_SC0 and camera 0's, without robust ones.
TEST_F(Deviations, ThroughBothStagesMayLeaveOutCamerasOwnOffsets) {
  const std::string robust = R"("robust_std": [3, 1, 1, 1, 1, 1, 1])";
  const auto stated =
      CalibrationFile(write(file(imuCovariance({"time_offset.cam1"}), robust.c_str())))
          .deviations();
  EXPECT_EQ(stated.at("tx").std, 3);
  EXPECT_EQ(stated.at("time_offset.cam1").std, 0);
  const auto refused = [&](const std::vector<std::string>& further, const char* words) {
    return faultOf(
        [&] { (void)CalibrationFile(write(file(imuCovariance(further), words))).deviations(); });
  };
  EXPECT_EQ(refused({"a", "b"}, R"("robust_std": [1, 1, 1, 1, 1, 1, 1, 1])"),
            InputFault::kContradiction);
  EXPECT_EQ(refused({"a"}, R"("robust_std": [1, 1, 1, 1, 1, 1, 1], "robust_dof": [1, 1])"),
            InputFault::kContradiction);
}

// The camera stage has no such offsets: seven of ten deviations are not its first parameters'.
TEST_F(Deviations, OfTheCameraStageAreOfAllItsParameters) {
  const auto read = [&](const std::string& robust) {
    return faultOf([&] {
      (void)CalibrationFile(
          write(fmt::format(
              R"({{"schema": 1, "cameras": [], "stages": {{"camera": {{"robust_std": [{}]}}}},
"covariance": {{"camera": {}}}}})",
              robust, imuCovariance({"a", "b", "c"}))))
          .deviations();
    });
  };
  EXPECT_EQ(read("1, 1, 1, 1, 1, 1, 1, 1, 1, 1"), std::nullopt);
  EXPECT_EQ(read("1, 1, 1, 1, 1, 1, 1"), InputFault::kContradiction);
}

// With given cameras there are none through both stages, but those of the tests for faults.
TEST_F(Deviations, OfGivenCamerasAreThoseOfTheTestsForFaults) {
  const auto stated =
      CalibrationFile(
          write(file(
              imuCovariance(),
              R"("faults": {"robust_std": [3, 1, 1, 1, 1, 1, 1], "robust_dof": [6, 1, 1, 1, 1, 1, 1]})")))
          .deviations();
  EXPECT_EQ(stated.at("tx").std, 3);  // formal: 2
  EXPECT_EQ(stated.at("tx").dof, 6);
}

// The camera-IMU stage estimates the cameras again, from more.
TEST_F(Deviations, OfTwoStagesTheLastCounts) {
  const std::string path = write(file(covariance("cam0.fu"), ""));
  EXPECT_THAT(deviationsOf(path), ElementsAre(Pair("T_SC0.tx", 3), Pair("cam0.fu", 2)));
  const auto cameras = CalibrationFile(path).extras().cameras;
  ASSERT_TRUE(cameras);
  EXPECT_EQ(cameras->names.size(), 2U);
}

// A stage without a focal length held the cameras: their covariance is the camera stage's.
TEST_F(Deviations, AStageThatHeldTheCamerasSaysNothingOfThem) {
  const auto cameras = CalibrationFile(write(file(covariance("T_SC0.ty"), ""))).extras().cameras;
  ASSERT_TRUE(cameras);
  EXPECT_THAT(cameras->names, ElementsAre("cam0.fu"));
  EXPECT_EQ(cameras->matrix(0, 0), 0.25);
}

TEST_F(Deviations, OtherToolsStateNone) {
  EXPECT_THAT(CalibrationFile(folder_.write("chain.yaml", kCamchainImuYaml)).deviations(),
              IsEmpty());
  EXPECT_EQ(CalibrationFile(folder_.path("chain.yaml")).extras().tool, "kalibr");
}

TEST_F(Deviations, FaultsNameTheirLine) {
  const auto refusal = [&](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return refusalOf(
        [&] { (void)CalibrationFile(write(text.replace(at, from.size(), to))).deviations(); });
  };
  const std::string good = file(covariance("T_SC0.ty"), R"("robust_std": [5, 7])");
  const struct {
    const char* from;
    const char* to;
    int line;
    InputFault code;
  } cases[] = {{"[[4, 1], [1, 9]]", "[[4, 1]]", 6, InputFault::kContradiction},
               {"[[4, 1], [1, 9]]", "[[4, 1], [1]]", 6, InputFault::kContradiction},
               {"[[4, 1], [1, 9]]", "[[4, 1], [1, -9]]", 6, InputFault::kOutOfRange},
               {"[5, 7]", "[5]", 2, InputFault::kContradiction},
               {"[5, 7]", "[5, -7]", 2, InputFault::kOutOfRange}};
  for (const auto& c : cases) {
    const auto fault = refusal(good, c.from, c.to);
    ASSERT_TRUE(fault) << c.to;
    EXPECT_EQ(fault->code(), c.code) << fault->what();
    EXPECT_EQ(fault->line(), c.line) << fault->what();
  }
}

}  // namespace
}  // namespace plumbline
