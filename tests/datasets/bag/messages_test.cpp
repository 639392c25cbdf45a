// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/messages.h"

#include <gtest/gtest.h>

#include "tests/datasets/bag/written_bag.h"

namespace plumbline {
namespace {

constexpr TimeNs kStamp = 1'700'000'000'123'456'789;

struct Layout {
  const char* name;
  Serialization layout;
  bool big_endian;
};

class Messages : public testing::TestWithParam<Layout> {};

INSTANTIATE_TEST_SUITE_P(Layouts, Messages,
                         testing::Values(Layout{"Ros1", Serialization::kRos1, false},
                                         Layout{"Cdr", Serialization::kCdr, false},
                                         Layout{"BigEndianCdr", Serialization::kCdr, true}),
                         [](const auto& info) { return info.param.name; });

WrittenMessage imageIn(const Layout& l) {
  return imageMessage(l.layout, kStamp, {3, 2, "mono8", "abcdef", 0, 3}, l.big_endian);
}

WrittenMessage imuIn(const Layout& l) {
  return imuMessage(l.layout, {kStamp, {0.1, -0.2, 0.3}, {1, 2, -9.81}}, l.big_endian);
}

TEST_P(Messages, ImageHasItsFields) {
  const WrittenMessage written = imageIn(GetParam());
  const auto image = decodeImage(written.message());
  ASSERT_TRUE(image);
  EXPECT_EQ(image->t, kStamp);
  EXPECT_EQ(image->width, 3U);
  EXPECT_EQ(image->height, 2U);
  EXPECT_EQ(image->encoding, "mono8");
  EXPECT_EQ(image->step, 3U);
  EXPECT_EQ(image->data, "abcdef");
}

TEST_P(Messages, ImuHasRatesAndSpecificForcesAfterItsCovariances) {
  const WrittenMessage written = imuIn(GetParam());
  const auto sample = decodeImu(written.message());
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->t, kStamp);
  EXPECT_EQ(sample->gyro, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(sample->accel, Eigen::Vector3d(1, 2, -9.81));
}

TEST_P(Messages, CutAnywhereTheyAreNone) {
  const std::string image = imageIn(GetParam()).content(), imu = imuIn(GetParam()).content();
  for (std::size_t size = 0; size < image.size(); ++size) {
    EXPECT_FALSE(decodeImage({"/t", std::string_view(image).substr(0, size), GetParam().layout}));
  }
  for (std::size_t size = 0; size < imu.size(); ++size) {
    EXPECT_FALSE(decodeImu({"/t", std::string_view(imu).substr(0, size), GetParam().layout}));
  }
}

TEST_P(Messages, CountBeyondTheEndIsNone) {
  WrittenMessage m(GetParam().layout, GetParam().big_endian);
  m.header(kStamp).text("jpeg").number(std::uint32_t{0xffffffff});
  EXPECT_FALSE(decodeCompressedImage(m.message()));
}

TEST(Messages, CompressedImageKeepsTheFile) {
  const WrittenMessage m = compressedMessage(Serialization::kCdr, kStamp, "\xff\xd8 a file");
  const auto image = decodeCompressedImage(m.message());
  ASSERT_TRUE(image);
  EXPECT_EQ(image->t, kStamp);
  EXPECT_EQ(image->format, "mono8; jpeg compressed");
  EXPECT_EQ(image->data, "\xff\xd8 a file");
}

// ROS 2 counts seconds with a sign, ROS 1 without: until 2106.
TEST(Messages, SecondsAfter2038StayPositiveInRos1) {
  WrittenMessage m(Serialization::kRos1);
  m.header(3'000'000'000'000'000'000).text("").bytes("");
  EXPECT_EQ(decodeCompressedImage(m.message())->t, 3'000'000'000'000'000'000);
}

}  // namespace
}  // namespace plumbline
