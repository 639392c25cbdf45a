// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/rig.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Stated = std::vector<StatedCamera>;

TEST(MatchStated, ATopicTellsMoreThanAPlaceInAFile) {
  const Stated rig{{"cam0", "/cam0/image_raw"}, {"cam1", "/cam1/image_raw"}, {"cam2", "/wide"}};
  const Stated file{{"cam0", "/wide"}, {"cam1", "/cam0/image_raw"}, {"cam2", "/cam1/image_raw"}};
  EXPECT_THAT(matchStated(rig, file).at, ElementsAre(1U, 2U, 0U));
  const Stated second{{"cam0", "/cam1/image_raw"}};
  EXPECT_THAT(matchStated(rig, second).at, ElementsAre(std::nullopt, 0U, std::nullopt));
}

TEST(MatchStated, NamesTellWhereTopicsAreOfTwoRecordings) {
  const Stated ours{{"cam0", "/cam0/image_raw"}, {"cam1", "/cam1/image_raw"}};
  const Stated bag{{"cam0", "/camera/infra1"}, {"cam1", "/camera/infra2"}};
  EXPECT_THAT(matchStated(ours, bag).at, ElementsAre(0U, 1U));
  EXPECT_FALSE(matchStated(ours, bag).by_place);
  EXPECT_THAT(matchStated({{"cam1", ""}}, {{"cam0", ""}, {"cam1", ""}}).at, ElementsAre(1U));
  // A list that knows the topics of the other knows this one, too.
  const Stated mixed{{"cam0", "/camera/infra1"}, {"cam1", "/camera/color"}};
  EXPECT_THAT(matchStated(bag, mixed).at, ElementsAre(0U, std::nullopt));
}

TEST(MatchStated, OrderCountsOnlyWhereNothingElseTells) {
  const CameraMatch match =
      matchStated({{"left", ""}, {"right", ""}}, {{"cam0", ""}, {"cam1", ""}});
  EXPECT_TRUE(match.by_place);
  EXPECT_THAT(match.at, ElementsAre(0U, 1U));
  EXPECT_THAT(matchStated({{"cam0", ""}}, {{"cam1", ""}}).at, ElementsAre(std::nullopt));
  EXPECT_THAT(matchStated({{"left", ""}}, {{"right", ""}}).at, ElementsAre(std::nullopt));
}

Session sessionOf(const std::vector<std::string>& names) {
  Session session;
  for (const std::string& name : names) {
    session.cameras.emplace_back();
    session.cameras.back().name = name;
    session.cameras.back().resolution = {752, 480};
  }
  return session;
}

/// A camchain of the rig's second camera, then the first.
Calibration reordered() {
  Calibration c = simulatedRig("euroc").calibration;
  const Transform T_C0C1 = c.cameras[1].T_C0Ci;
  std::swap(c.cameras[0], c.cameras[1]);
  c.cameras[0].name = "cam0";
  c.cameras[0].rostopic = "/cam1/image_raw";
  c.cameras[0].T_C0Ci = Transform();
  c.cameras[1].name = "cam1";
  c.cameras[1].rostopic = "/cam0/image_raw";
  c.cameras[1].T_C0Ci = T_C0C1.inverse();
  c.imu->T_SC0 = c.imu->T_SC0 * T_C0C1;
  return c;
}

TEST(MatchCalibration, AnOrderOfCamerasIsResolvedByTheirTopics) {
  const Calibration truth = simulatedRig("euroc").calibration;
  const Calibration both = matchCalibration(reordered(), "chain.yaml", sessionOf({"cam0", "cam1"}));
  ASSERT_EQ(both.cameras.size(), 2U);
  EXPECT_EQ(both.cameras[1].name, "cam1");
  EXPECT_EQ(both.cameras[1].intrinsics.projection, truth.cameras[1].intrinsics.projection);
  EXPECT_LT(boxminus(both.cameras[1].T_C0Ci, truth.cameras[1].T_C0Ci).norm(), 1e-12);
  EXPECT_LT(boxminus(both.imu->T_SC0, truth.imu->T_SC0).norm(), 1e-12);
}

TEST(MatchCalibration, TheSecondCameraAloneIsKnownByItsTopic) {
  Calibration second = reordered();
  second.cameras.pop_back();
  const Calibration matched = matchCalibration(second, "chain.yaml", sessionOf({"cam1"}));
  ASSERT_EQ(matched.cameras.size(), 1U);
  EXPECT_EQ(matched.cameras[0].name, "cam1");
  EXPECT_EQ(matched.imu->T_SC0.t, second.imu->T_SC0.t);
}

std::string refusal(const Calibration& given, const Session& session) {
  try {
    (void)matchCalibration(given, "chain.yaml", session);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MatchCalibration, RefusesWhatNothingTellsWithItsCure) {
  Calibration second = reordered();
  second.cameras.pop_back();
  EXPECT_THAT(refusal(second, sessionOf({"cam0"})),
              AllOf(HasSubstr("chain.yaml: has no cam0"), HasSubstr("cam0 (/cam1/image_raw)"),
                    HasSubstr("rostopic")));
  for (CameraCalibration& camera : second.cameras) camera.rostopic.clear();
  EXPECT_THAT(refusal(second, sessionOf({"left"})), HasSubstr("has no left"));
  second.cameras[0].rostopic = "/color";
  Session session = sessionOf({"cam0"});
  session.cameras[0].rostopic = "/infra1";
  EXPECT_THAT(refusal(second, session), HasSubstr("of topic /color"));
}

}  // namespace
}  // namespace plumbline
