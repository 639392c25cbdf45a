// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/bag/bag.h"
#include "datasets/bag/messages.h"
#include "tests/datasets/bag/written_mcap.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

ImuSample mcapSample(int number) {
  return {1'700'000'000'000'000'000 + number, {0.1 * number, 0, 1}, {0, number + 1.0, 9.81}};
}

/// Three samples between images, which nobody asks for.
std::string mcapRecording(const std::string& compression) {
  WrittenMcap mcap(compression);
  mcap.topic("/cam0/image_raw", "sensor_msgs/msg/Image");
  mcap.topic("/imu0", "sensor_msgs/msg/Imu");
  for (int i = 0; i < 3; ++i) {
    mcap.message("/cam0/image_raw", i, imageMessage(Serialization::kCdr, i, {2, 1, "mono8", "ab"}));
    mcap.message("/imu0", i, imuMessage(Serialization::kCdr, mcapSample(i)));
  }
  return mcap.content();
}

class McapBag : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Compressions, McapBag, testing::Values("", "lz4", "zstd"));

TEST_P(McapBag, TopicsAndMessagesAreTold) {
  const TemporaryFolder folder;
  const auto bag = openBag(folder.write("a.mcap", mcapRecording(GetParam())));
  const auto topics = bag->topics();
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_EQ(topics[0].name, "/cam0/image_raw");
  EXPECT_EQ(topics[1].type, "sensor_msgs/Imu");
  EXPECT_EQ(topics[1].messages, 3U);
  std::vector<ImuSample> samples;
  bag->read({"/imu0"}, [&](const BagMessage& m) { samples.push_back(decodeImu(m).value()); });
  ASSERT_EQ(samples.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(samples[static_cast<std::size_t>(i)].t, mcapSample(i).t);
    EXPECT_EQ(samples[static_cast<std::size_t>(i)].accel, mcapSample(i).accel);
  }
}

TEST_P(McapBag, CutAnywhereItIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = mcapRecording(GetParam());
  for (std::size_t size = 8; size < whole.size(); size += 7) {
    const std::string path = folder.write("cut.mcap", whole.substr(0, size));
    EXPECT_EQ(faultOf([&] { openBag(path); }), InputFault::kSyntax) << size;
  }
}

// The checksum of a chunk is over what it holds.
TEST_P(McapBag, AChangedByteOfAChunkIsToldAndNotImported) {
  const TemporaryFolder folder;
  std::string changed = mcapRecording(GetParam());
  changed[changed.find("\x89MCAP0", 1) / 3] ^= 0x55;
  const auto refusal = refusalOf(
      [&] { openBag(folder.write("a.mcap", changed))->read({"/imu0"}, [](const BagMessage&) {}); });
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->what(), HasSubstr("mcap recover"));
}

TEST(McapBag, MessagesOfRos1KeepTheirLayout) {
  const TemporaryFolder folder;
  WrittenMcap mcap("");
  mcap.topic("/imu0", "sensor_msgs/Imu", "ros1");
  mcap.message("/imu0", 0, imuMessage(Serialization::kRos1, mcapSample(2)));
  const auto bag = openBag(folder.write("a.mcap", mcap.content()));
  EXPECT_EQ(bag->topics()[0].type, "sensor_msgs/Imu");
  bag->read({"/imu0"}, [&](const BagMessage& m) { EXPECT_EQ(decodeImu(m)->t, mcapSample(2).t); });
}

// Foxglove's writers put messages of JSON beside those of ROS.
TEST(McapBag, MessagesOfAnotherEncodingAreLeftOut) {
  const TemporaryFolder folder;
  WrittenMcap mcap("");
  mcap.topic("/imu0", "sensor_msgs/msg/Imu");
  mcap.topic("/notes", "note", "json");
  mcap.message("/notes", 0, WrittenMessage(Serialization::kRos1).text("{}"));
  mcap.message("/imu0", 0, imuMessage(Serialization::kCdr, mcapSample(2)));
  const auto bag = openBag(folder.write("a.mcap", mcap.content()));
  ASSERT_EQ(bag->topics().size(), 1U);
  int told = 0;
  bag->read({"/imu0", "/notes"}, [&](const BagMessage& m) {
    EXPECT_EQ(decodeImu(m)->t, mcapSample(2).t);
    ++told;
  });
  EXPECT_EQ(told, 1);
}

TEST(McapBag, AnotherCompressionIsNamed) {
  const TemporaryFolder folder;
  const auto refusal = refusalOf([&] {
    openBag(folder.write("a.mcap", mcapRecording("brotli")))->read({}, [](const BagMessage&) {});
  });
  EXPECT_EQ(refusal->code(), InputFault::kUnsupported);
  EXPECT_THAT(refusal->what(), HasSubstr("brotli"));
}

}  // namespace
}  // namespace plumbline
