// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>

#include "datasets/bag/import_bag.h"
#include "datasets/session/session_reader.h"
#include "tests/datasets/bag/written_bag.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {

/// A message whose bytes are written as they are.
struct RawMessage {
  std::string type, bytes;
};

}  // namespace plumbline

// What rosbag asks of a type of messages.
namespace ros {
namespace message_traits {
template <>
struct MD5Sum<plumbline::RawMessage> {
  static const char* value(const plumbline::RawMessage& m) { return m.type.c_str(); }
  static const char* value() { return "*"; }
};
template <>
struct DataType<plumbline::RawMessage> {
  static const char* value(const plumbline::RawMessage& m) { return m.type.c_str(); }
  static const char* value() { return "*"; }
};
template <>
struct Definition<plumbline::RawMessage> {
  static const char* value(const plumbline::RawMessage&) { return ""; }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<plumbline::RawMessage> {
  template <class Stream>
  static void write(Stream& out, const plumbline::RawMessage& m) {
    std::memcpy(out.advance(serializedLength(m)), m.bytes.data(), m.bytes.size());
  }
  static std::uint32_t serializedLength(const plumbline::RawMessage& m) {
    return static_cast<std::uint32_t>(m.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace plumbline {
namespace {

constexpr TimeNs kStart = 1'600'000'000'000'000'000;

/// Four frames of one camera and eight samples, written by rosbag itself.
void writeBag(const std::string& path, rosbag::CompressionType compression) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(compression);
  for (int k = 0; k < 4; ++k) {
    const TimeNs t = kStart + k * 50'000'000;
    const WrittenImage image{4, 2, "mono8", std::string(8, static_cast<char>('a' + k))};
    bag.write(
        "/cam0/image_raw", ros::Time(10 + k),
        RawMessage{"sensor_msgs/Image", imageMessage(Serialization::kRos1, t, image).content()});
  }
  for (int i = 0; i < 8; ++i) {
    const ImuSample sample{kStart + i * 5'000'000, {0.1 * i, 0, 1}, {0, 0, 9.81}};
    bag.write("/imu0", ros::Time(20 + i),
              RawMessage{"sensor_msgs/Imu", imuMessage(Serialization::kRos1, sample).content()});
  }
  bag.close();
}

class Ros1Bag : public testing::TestWithParam<rosbag::CompressionType> {};

INSTANTIATE_TEST_SUITE_P(Compressions, Ros1Bag,
                         testing::Values(rosbag::compression::Uncompressed,
                                         rosbag::compression::BZ2, rosbag::compression::LZ4));

TEST_P(Ros1Bag, IsImportedAsItsSensorsMeasured) {
  const TemporaryFolder folder;
  writeBag(folder.path("recording.bag"), GetParam());
  const auto topics = topicsOf(std::vector{folder.path("recording.bag")});
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_EQ(topics[0].name, "/cam0/image_raw");
  EXPECT_EQ(topics[0].messages, 4U);
  EXPECT_EQ(topics[1].type, "sensor_msgs/Imu");

  BagImport request;
  request.bags = {folder.path("recording.bag")};
  std::filesystem::create_directory(folder.path("session"));
  const auto sensors = importBags(request, folder.path("session"));
  ASSERT_EQ(sensors.size(), 2U);
  EXPECT_EQ(sensors[0].count, 4U);
  EXPECT_EQ(sensors[0].first, kStart);
  EXPECT_EQ(sensors[1].count, 8U);
  EXPECT_NEAR(sensors[1].rate_hz, 200, 1e-9);
}

TEST(Ros1Bag, ATopicOfTwoTypesIsToldByName) {
  const TemporaryFolder folder;
  writeBag(folder.path("recording.bag"), rosbag::compression::Uncompressed);
  {
    rosbag::Bag bag(folder.path("recording.bag"), rosbag::bagmode::Append);
    bag.write("/imu0", ros::Time(30), RawMessage{"std_msgs/String", std::string("\1\0\0\0a", 5)});
    bag.close();
  }
  const auto topics = topicsOf(std::vector{folder.path("recording.bag")});
  ASSERT_EQ(topics.size(), 3U);
  EXPECT_EQ(topics[1].messages, 8U);
  EXPECT_EQ(topics[2].type, "std_msgs/String");
  EXPECT_EQ(topics[2].messages, 1U);

  BagImport request;
  request.bags = {folder.path("recording.bag")};
  std::filesystem::create_directory(folder.path("session"));
  const auto refusal = refusalOf([&] { importBags(request, folder.path("session")); });
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code(), InputFault::kContradiction);
  EXPECT_THAT(refusal->what(), testing::HasSubstr("topic /imu0 is sensor_msgs/Imu"));
  // Where it is not used it does no harm.
  request.import_imu = false;
  EXPECT_EQ(importBags(request, folder.path("session")).size(), 1U);
}

TEST(Ros1Bag, DamagedOnesAreRefused) {
  const TemporaryFolder folder;
  writeBag(folder.path("whole.bag"), rosbag::compression::Uncompressed);
  const auto size = std::filesystem::file_size(folder.path("whole.bag"));
  for (const auto left : {std::uintmax_t{14}, size / 2, size - 1}) {
    std::filesystem::copy_file(folder.path("whole.bag"), folder.path("cut.bag"),
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(folder.path("cut.bag"), left);
    const auto refusal = refusalOf([&] { topicsOf(std::vector{folder.path("cut.bag")}); });
    ASSERT_TRUE(refusal) << left;
    EXPECT_EQ(refusal->code(), InputFault::kSyntax);
    EXPECT_THAT(refusal->what(), testing::HasSubstr("rosbag reindex"));
  }
}

}  // namespace
}  // namespace plumbline
