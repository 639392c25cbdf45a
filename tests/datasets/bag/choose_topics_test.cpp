// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/choose_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/datasets/refusal.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<BagTopic> kTopics{{"/camera/depth/image", kImageType, 10},
                                    {"/imu0", kImuType, 100},
                                    {"/left/image_raw", kImageType, 10},
                                    {"/left/image_raw/compressed", kCompressedImageType, 10},
                                    {"/right/image_raw/compressed", kCompressedImageType, 10},
                                    {"/tf", "tf2_msgs/TFMessage", 5}};

std::vector<std::string> camerasOf(const BagImport& request) {
  std::vector<std::string> names;
  for (const BagTopic& topic : chooseTopics(kTopics, request, "").cameras) {
    names.push_back(topic.name);
  }
  return names;
}

TEST(ChooseTopics, AllCamerasOnceAndNoDepth) {
  EXPECT_THAT(camerasOf({}), ElementsAre("/left/image_raw", "/right/image_raw/compressed"));
}

// `ros2 bag record -a` registers what image_transport offers, messages or none.
TEST(ChooseTopics, WhatNobodyPublishedIsNoCamera) {
  std::vector<BagTopic> topics = kTopics;
  topics.push_back({"/left/image_raw/compressedDepth", kCompressedImageType, 0});
  topics.push_back({"/right/image_raw", kImageType, 0});
  std::vector<std::string> names;
  for (const BagTopic& topic : chooseTopics(topics, {}, "").cameras) names.push_back(topic.name);
  EXPECT_THAT(names, ElementsAre("/left/image_raw", "/right/image_raw/compressed"));
}

TEST(ChooseTopics, NamedCamerasKeepTheirOrder) {
  BagImport request;
  request.camera_topics = {"/right/image_raw/compressed", "/camera/depth/image"};
  EXPECT_THAT(camerasOf(request),
              ElementsAre("/right/image_raw/compressed", "/camera/depth/image"));
}

TEST(ChooseTopics, TheOnlyImuOrNone) {
  EXPECT_EQ(chooseTopics(kTopics, {}, "").imu->name, "/imu0");
  BagImport request;
  request.import_imu = false;
  EXPECT_FALSE(chooseTopics(kTopics, request, "").imu);
}

TEST(ChooseTopics, OfSeveralImusTheStatedOne) {
  std::vector<BagTopic> topics = kTopics;
  topics.push_back({"/imu1", kImuType, 100});
  EXPECT_EQ(chooseTopics(topics, {}, "/imu1").imu->name, "/imu1");
  BagImport request;
  request.imu_topic = "/imu0";  // before what imu.yaml states
  EXPECT_EQ(chooseTopics(topics, request, "/imu1").imu->name, "/imu0");
  EXPECT_EQ(faultOf([&] { chooseTopics(topics, {}, "/other"); }), InputFault::kSeveralImus);
}

TEST(ChooseTopics, WhatIsMissingIsToldWithWhatIsThere) {
  const auto refused = [&](const BagImport& request, const std::string& what) {
    const auto refusal = refusalOf([&] { chooseTopics(kTopics, request, ""); });
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->code(), InputFault::kNoTopic);
    EXPECT_THAT(refusal->what(), HasSubstr(what));
    EXPECT_THAT(refusal->what(), HasSubstr("/left/image_raw (sensor_msgs/Image)"));
  };
  BagImport request;
  request.camera_topics = {"/cam0"};
  refused(request, "there is no topic /cam0");
  request.camera_topics = {"/tf"};
  refused(request, "/tf has no images (tf2_msgs/TFMessage)");
  request = {};
  request.imu_topic = "/left/image_raw";
  refused(request, "/left/image_raw is no IMU");
  request.camera_topics = {"/left/image_raw", "/left/image_raw"};
  EXPECT_EQ(faultOf([&] { chooseTopics(kTopics, request, ""); }), InputFault::kDuplicate);
}

TEST(ChooseTopics, ATopicOfTwoTypesIsToldWhereItIsNeeded) {
  std::vector<BagTopic> topics = kTopics;
  topics.push_back({"/tf", "tf/tfMessage", 5});
  EXPECT_EQ(chooseTopics(topics, {}, "").cameras.size(), 2U);
  topics.push_back({"/imu0", "my_msgs/Imu", 0});
  EXPECT_EQ(chooseTopics(topics, {}, "").imu->name, "/imu0");
  topics.back().messages = 100;
  const auto refusal = refusalOf([&] { chooseTopics(topics, {}, ""); });
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code(), InputFault::kContradiction);
  EXPECT_THAT(refusal->what(), HasSubstr("/imu0 is sensor_msgs/Imu in one part of the recording "
                                         "and my_msgs/Imu in another"));
  // By name too, whichever of its types comes first.
  topics.insert(topics.begin(), {{"/imu0", "a/Imu", 1}, {"/left/image_raw", "a/Image", 1}});
  BagImport request;
  request.imu_topic = "/imu0";
  EXPECT_EQ(faultOf([&] { chooseTopics(topics, request, ""); }), InputFault::kContradiction);
  request = {};
  request.import_imu = false;
  request.camera_topics = {"/left/image_raw"};
  EXPECT_EQ(faultOf([&] { chooseTopics(topics, request, ""); }), InputFault::kContradiction);
}

TEST(ChooseTopics, AnImuThatIsDescribedMustBeThere) {
  const std::vector<BagTopic> cameras{{"/cam0", kImageType, 9}};
  BagImport request;
  EXPECT_FALSE(chooseTopics(cameras, request, "").imu);
  request.imu_path = "imu.yaml";
  EXPECT_EQ(faultOf([&] { chooseTopics(cameras, request, "/imu0"); }), InputFault::kNoImuSamples);
  request.import_imu = false;
  EXPECT_FALSE(chooseTopics(cameras, request, "/imu0").imu);
}

TEST(ChooseTopics, ABagWithoutImagesIsNoSession) {
  EXPECT_EQ(faultOf([&] { chooseTopics({{"/imu0", kImuType, 9}}, {}, ""); }), InputFault::kNoTopic);
}

}  // namespace
}  // namespace plumbline
