// SPDX-License-Identifier: BSD-3-Clause
// What the operator of a guided recording was asked for.
#include "datasets/session/suggestions_reader.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/session/session_files.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

constexpr const char* kHeader = "#t_ns,stage,id,T_FC0\n";

class Suggestions : public ::testing::Test {
 protected:
  std::vector<Suggestion> read(const std::string& rows) {
    folder_.write("suggestions.csv", kHeader + rows);
    return readSuggestions(folder_.path("suggestions.csv"));
  }
  TemporaryFolder folder_;
};

TEST_F(Suggestions, APoseIsAQuaternionOrAMatrix) {
  // A quarter turn about z.
  const auto list = read(
      "1000000000000000000,camera,0,1,2,3,0,0,0.70710678,0.70710678\n"
      "1000000001000000000,camera-imu,0,0,-1,0,1,1,0,0,2,0,0,1,3,0,0,0,1\n"
      "1000000002000000000,camera,1,0,-1,0,1,1,0,0,2,0,0,1,3\n");
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0].stage, GuideStage::kCamera);
  EXPECT_EQ(list[1].stage, GuideStage::kCameraImu);
  EXPECT_EQ(list[2].id, 1);
  for (const Suggestion& s : list) {
    EXPECT_EQ(s.camera, -1) << "not stated";
    EXPECT_LT((s.T_FC0.t - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT((s.T_FC0.R * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-7);
  }
}

TEST_F(Suggestions, TheCameraStandsAfterThePose) {
  const auto list = read(
      "1000000000000000000,camera,0,1,2,3,0,0,0,1,1\n"
      "1000000001000000000,camera,1,0,-1,0,1,1,0,0,2,0,0,1,3,0\n"
      "1000000002000000000,camera,2,0,-1,0,1,1,0,0,2,0,0,1,3,0,0,0,1,2\n");
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0].camera, 1);
  EXPECT_EQ(list[1].camera, 0);
  EXPECT_EQ(list[2].camera, 2);
}

TEST_F(Suggestions, AreFoundAtBothLevels) {
  writeGoodSession(folder_, "mav0/");
  EXPECT_FALSE(findSuggestions(folder_.path()));
  const std::string path = folder_.write("suggestions.csv", kHeader);
  for (const std::string& session : {folder_.path(), folder_.path("mav0")}) {
    const auto found = findSuggestions(session);
    ASSERT_TRUE(found) << session;
    EXPECT_TRUE(std::filesystem::equivalent(*found, path));
  }
}

TEST_F(Suggestions, NoneAreNoFault) { EXPECT_TRUE(read("").empty()); }

TEST_F(Suggestions, FaultsNameFileAndLine) {
  const std::string good = "1000000000000000000,camera,0,1,2,3,0,0,0,1\n";
  for (const auto& [row, code] : std::initializer_list<std::pair<const char*, InputFault>>{
           {"1000000001000000000,views,1,1,2,3,0,0,0,1\n", InputFault::kUnknownWord},
           {"1000000001000000000,camera,0,1,2,3,0,0,0,1\n", InputFault::kDuplicate},
           {"999999999000000000,camera,1,1,2,3,0,0,0,1\n", InputFault::kBadOrder},
           {"1000000001", InputFault::kTruncated},
           {"1000000001000000000,camera,1,1,2,3,1,0,0,1\n", InputFault::kNotRigid},
           {"1000000001000000000,camera,1,1,2,3,0,0,0\n", InputFault::kBadNumber},
           {"1000000001000000000,camera,1,1,2,3,0,0,0,1,-1\n", InputFault::kBadNumber},
           {"1000000001000000000,camera,1,1,2,3,0,0,0,1,0.5\n", InputFault::kBadNumber},
           {"1000000001000000000,camera,1,1,0,0,0,0,1,0,0,0,0,-1,0\n", InputFault::kNotRigid},
           {"1000000001000000000,camera,x,1,2,3,0,0,0,1\n", InputFault::kBadNumber},
           {"1000000001000000000,camera,1,1,2,nan,0,0,0,1\n", InputFault::kNotFinite}}) {
    const std::string text = good + row;
    const auto refusal = refusalOf([&] { (void)read(text); });
    ASSERT_TRUE(refusal) << row;
    EXPECT_EQ(refusal->line(), 3) << row;
    EXPECT_EQ(refusal->code(), code) << refusal->what();
  }
}

}  // namespace
}  // namespace plumbline
