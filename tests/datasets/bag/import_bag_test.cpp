// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/import_bag.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/images/image_io.h"
#include "datasets/session/session_reader.h"
#include "tests/datasets/bag/written_bag.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr TimeNs kBagStart = 1'700'000'000'000'000'000;
constexpr TimeNs kFrame = 50'000'000, kSample = 5'000'000;  // [ns]
constexpr const char* kBagTarget =
    "target_type: aprilgrid\ntagRows: 6\ntagCols: 6\ntagSize: 0.088\ntagSpacing: 0.3\n";
constexpr const char* kBagImu =
    "rostopic: /imu0\nupdate_rate: 200\naccelerometer_noise_density: 0.002\n"
    "accelerometer_random_walk: 0.003\ngyroscope_noise_density: 0.00017\n"
    "gyroscope_random_walk: 0.00002\n";

std::string contentOfFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

WrittenImage pictureOf(int number) {
  WrittenImage image{6, 4, "mono8", std::string(24, '\0')};
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<char>(10 * number + static_cast<int>(i));
  }
  return image;
}

ImuSample sampleOf(int number) {
  return {kBagStart + number * kSample, {0.1 * number, 0.2, -0.3}, {0.5, 0.25 * number, 9.81}};
}

WrittenMessage cdrImage(TimeNs t, const WrittenImage& image) {
  return imageMessage(Serialization::kCdr, t, image);
}
WrittenMessage cdrImu(const ImuSample& sample) { return imuMessage(Serialization::kCdr, sample); }

/// A folder with a bag of two cameras and an IMU, which is not closed before it is imported.
class ImportBag : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("target.yaml", kBagTarget);
    folder_.write("imu.yaml", kBagImu);
    request_.bags = {folder_.path("bag.db3")};
    request_.target_path = folder_.path("target.yaml");
    request_.imu_path = folder_.path("imu.yaml");
  }

  WrittenRos2Bag begun(const std::string& name = "bag.db3") const {
    WrittenRos2Bag bag(folder_.path(name));
    bag.topic("/cam0/image_raw", "sensor_msgs/msg/Image");
    bag.topic("/cam1/image_raw", "sensor_msgs/msg/Image");
    bag.topic("/imu0", "sensor_msgs/msg/Imu");
    return bag;
  }
  /// Frames 0 .. 2 and samples 0 .. 9, the frames received in the order 1, 0, 2, a second late.
  WrittenRos2Bag filled() const {
    WrittenRos2Bag bag = begun();
    int received = 0;
    for (const int k : {1, 0, 2}) {
      const TimeNs at = kBagStart + 1'000'000'000 + received++;
      bag.message("/cam0/image_raw", at, cdrImage(kBagStart + k * kFrame, pictureOf(k)));
      bag.message("/cam1/image_raw", at, cdrImage(kBagStart + k * kFrame, pictureOf(k + 3)));
    }
    for (int i = 0; i < 10; ++i) {
      bag.message("/imu0", kBagStart + 1'000'000'000 + i, cdrImu(sampleOf(i)));
    }
    return bag;
  }

  std::vector<ImportedSensor> import(const std::string& to = "session") const {
    fs::create_directories(folder_.path(to));
    return importBags(request_, folder_.path(to));
  }
  BadInput refusal() const {
    const auto refused = refusalOf([&] { import(); });
    return refused ? *refused : BadInput(InputFault::kOther, "not refused");
  }
  void expectRefused(InputFault code, const std::string& words) const {
    const BadInput error = refusal();
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(words));
  }

  TemporaryFolder folder_;
  BagImport request_;
};

TEST_F(ImportBag, TheSessionHasTheSensorsByTheStampsOfTheirHeaders) {
  filled();
  const auto sensors = import();
  ASSERT_EQ(sensors.size(), 3U);
  EXPECT_EQ(sensors[0].name, "cam0");
  EXPECT_EQ(sensors[0].count, 3U);
  EXPECT_EQ(sensors[0].resolution, (Resolution{6, 4}));
  EXPECT_DOUBLE_EQ(sensors[0].rate_hz, 20);
  EXPECT_EQ(sensors[2].topic, "/imu0");
  EXPECT_EQ(sensors[2].count, 10U);

  const Recording read = readRecording(folder_.path("session"));
  ASSERT_EQ(read.session.cameras.size(), 2U);
  EXPECT_EQ(read.session.cameras[1].rostopic, "/cam1/image_raw");
  EXPECT_EQ(read.session.target.tagCount(), 36);
  for (int k = 0; k < 3; ++k) {
    const ImageFile& file = read.images[1][static_cast<std::size_t>(k)];
    EXPECT_EQ(file.t, kBagStart + k * kFrame);
    const GrayImage image = readGrayImage(file.path);
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(image.data()), 24), pictureOf(k + 3).data);
  }
  ASSERT_EQ(read.session.imu->samples.size(), 10U);
  EXPECT_EQ(read.session.imu->noise.gyro_density, 0.00017);
  for (int i = 0; i < 10; ++i) {
    const ImuSample& sample = read.session.imu->samples[static_cast<std::size_t>(i)];
    EXPECT_EQ(sample.t, sampleOf(i).t);
    EXPECT_TRUE(sample.gyro.isApprox(sampleOf(i).gyro, 1e-11));
    EXPECT_TRUE(sample.accel.isApprox(sampleOf(i).accel, 1e-11));
  }
}

TEST_F(ImportBag, WhatNobodyStatedIsNotMadeUp) {
  filled();
  request_.imu_path.reset();
  request_.target_path.reset();
  import();
  EXPECT_FALSE(fs::exists(folder_.path("session/imu.yaml")));
  EXPECT_FALSE(fs::exists(folder_.path("session/mav0/imu0/sensor.yaml")));
  EXPECT_FALSE(fs::exists(folder_.path("session/target.yaml")));
  EXPECT_TRUE(fs::exists(folder_.path("session/mav0/imu0/data.csv")));
}

TEST_F(ImportBag, OrderOfTheBagsAndThreadsChangeNothing) {
  filled();
  {
    WrittenRos2Bag more = begun("more.db3");
    more.message("/cam0/image_raw", 1, cdrImage(kBagStart + 3 * kFrame, pictureOf(7)));
    more.message("/cam1/image_raw", 1, cdrImage(kBagStart + 3 * kFrame, pictureOf(8)));
    more.message("/imu0", 1, cdrImu(sampleOf(10)));
  }
  request_.threads = 1;
  request_.bags = {folder_.path("bag.db3"), folder_.path("more.db3")};
  import("one");
  request_.threads = 0;
  std::swap(request_.bags[0], request_.bags[1]);
  import("other");
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path("one"))) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const fs::path name = fs::relative(entry.path(), folder_.path("one"));
    EXPECT_EQ(contentOfFile(entry.path()), contentOfFile(folder_.path("other") / name)) << name;
  }
  EXPECT_EQ(files, 8 + 4 + 2 + 2);  // images, cameras' texts, the IMU's, target.yaml and imu.yaml
}

TEST_F(ImportBag, EveryCameraHasItsOwnRate) {
  {
    WrittenRos2Bag bag = filled();
    for (int i = 0; i < 4; ++i) {  // twice as often as the frames between
      const TimeNs t = kBagStart + kFrame * i + kFrame / 2;
      bag.message("/cam1/image_raw", i, cdrImage(t, pictureOf(10 + i)));
    }
  }
  import();
  EXPECT_THAT(contentOfFile(folder_.path("session/mav0/cam0/sensor.yaml")),
              HasSubstr("rate_hz: 20.0\n"));
  EXPECT_THAT(contentOfFile(folder_.path("session/mav0/cam1/sensor.yaml")),
              HasSubstr("rate_hz: 40.0\n"));
}

TEST_F(ImportBag, AFaultOfAMessageNamesItsFileAndItsNumberThere) {
  filled();
  {
    WrittenRos2Bag more = begun("more.db3");
    more.message("/imu0", 1, cdrImu(sampleOf(10)));
    more.message("/imu0", 2, cdrImu({0, {1, 2, 3}, {4, 5, 6}}));
  }
  request_.bags.push_back(folder_.path("more.db3"));
  expectRefused(InputFault::kBadOrder, folder_.path("more.db3") + ": topic /imu0: message 2 has");
  EXPECT_EQ(refusal().path(), folder_.path("more.db3"));
}

// 0x09: delimited, of types that may grow. Vendors of DDS write it for types that are not ROS's.
TEST_F(ImportBag, AnotherKindOfCdrIsNamed) {
  {
    WrittenRos2Bag bag = filled();
    WrittenMessage message(Serialization::kCdr);
    bag.message("/imu0", std::numeric_limits<TimeNs>::max(), message.header(kBagStart));
  }
  {
    SQLite::Database bag(folder_.path("bag.db3"), SQLite::OPEN_READWRITE);
    bag.exec(
        "UPDATE messages SET data = X'000900000100000000000000' WHERE id = (SELECT MAX(id) "
        "FROM messages)");
  }
  expectRefused(InputFault::kUnsupported, "message 11 is CDR of kind 0x09");
}

TEST_F(ImportBag, CompressedImagesStayTheirFiles) {
  GrayImage picture(16, 8, 90);
  picture.at(3, 3) = 200;
  const std::string jpeg = encodeJpeg(picture, 90);
  {
    WrittenRos2Bag bag(folder_.path("bag.db3"));
    bag.topic("/cam/compressed", "sensor_msgs/msg/CompressedImage");
    bag.message("/cam/compressed", 5, compressedMessage(Serialization::kCdr, kBagStart, jpeg));
  }
  request_.import_imu = false;
  EXPECT_EQ(import().front().resolution, (Resolution{16, 8}));
  const Recording read = readRecording(folder_.path("session"), {.read_imu = false});
  EXPECT_EQ(contentOfFile(read.images[0][0].path), jpeg);
}

TEST_F(ImportBag, SixteenBitsReachTheImageReader) {
  {
    WrittenRos2Bag bag = begun();
    WrittenImage deep{2, 1, "mono16", {'\xff', '\x03', '\x00', '\x02'}, 0, 4};  // 1023, 512
    bag.message("/cam0/image_raw", 1, cdrImage(kBagStart, deep));
  }
  request_.camera_topics = {"/cam0/image_raw"};
  request_.import_imu = false;
  import();
  const std::string path =
      folder_.path("session/mav0/cam0/data/" + std::to_string(kBagStart) + ".png");
  EXPECT_EQ(bitsOfDeepImage(path), 10);
  const GrayImage image = readGrayImage(path);
  EXPECT_EQ(image.at(0, 0), 255);
  EXPECT_EQ(image.at(1, 0), 128);
}

TEST_F(ImportBag, TheSameMessageTwiceIsOneAndIsCounted) {
  WrittenRos2Bag bag = filled();
  bag.message("/cam0/image_raw", kBagStart, cdrImage(kBagStart, pictureOf(0)));
  bag.message("/imu0", kBagStart, cdrImu(sampleOf(4)));
  const auto sensors = import();
  EXPECT_EQ(sensors[0].repeated, 1U);
  EXPECT_EQ(sensors[1].repeated, 0U);
  EXPECT_EQ(sensors[2].repeated, 1U);
  EXPECT_EQ(sensors[2].count, 10U);
}

TEST_F(ImportBag, TwoDifferentMessagesOfOneStampAreRefused) {
  ImuSample other = sampleOf(4);
  other.gyro.x() += 1;
  filled().message("/imu0", kBagStart, cdrImu(other));
  expectRefused(InputFault::kDuplicate, "topic /imu0");
  fs::remove(folder_.path("bag.db3"));
  filled().message("/cam0/image_raw", kBagStart, cdrImage(kBagStart, pictureOf(9)));
  expectRefused(InputFault::kDuplicate, "topic /cam0/image_raw");
}

TEST_F(ImportBag, MessagesThatCannotBeUsedAreToldByTopicAndNumber) {
  const auto refused = [&](const std::string& topic, const WrittenMessage& message, InputFault code,
                           const std::string& words) {
    fs::remove(folder_.path("bag.db3"));
    WrittenRos2Bag bag = filled();
    bag.message(topic, std::numeric_limits<TimeNs>::max(), message);
    expectRefused(code, words);
  };
  const std::string cam = "/cam0/image_raw";
  refused(cam, cdrImage(0, pictureOf(1)), InputFault::kBadOrder, "message 4 has the stamp 0 ns");
  refused(cam, cdrImage(kBagStart + 9, {2, 2, "mono8", "abcd"}), InputFault::kContradiction,
          "message 4 is 2 x 2, those before it are 6 x 4");
  refused(cam, cdrImage(kBagStart + 9, {6, 4, "32FC1", std::string(24, 'a')}),
          InputFault::kUnsupported, "encoding '32FC1' has no grey image");
  refused(cam, cdrImage(kBagStart + 9, {6, 4, "mono8", "short"}), InputFault::kContradiction,
          "6 x 4 pixels of mono8 in rows of 6 bytes do not fit 5 bytes");
  refused(cam, WrittenMessage(Serialization::kCdr).header(kBagStart + 9), InputFault::kTruncated,
          "message 4 is cut, or not laid out as sensor_msgs/Image");
  ImuSample broken = sampleOf(11);
  broken.accel.y() = std::nan("");
  refused("/imu0", cdrImu(broken), InputFault::kNotFinite, "message 11");
  broken.t = 0;
  refused("/imu0", cdrImu(broken), InputFault::kBadOrder, "topic /imu0: message 11");
}

TEST_F(ImportBag, AnImuThatIsHalfFilledIsToldSo) {
  WrittenRos2Bag bag = begun();
  bag.message("/cam0/image_raw", 1, cdrImage(kBagStart, pictureOf(0)));
  bag.message("/imu0", 1, cdrImu({kBagStart, {0.1, 0, 0}, {0, 0, 0}}));
  request_.camera_topics = {"/cam0/image_raw"};
  expectRefused(InputFault::kEmpty, "every linear_acceleration is 0");
}

TEST_F(ImportBag, ACameraWithoutAnImageIsToldSo) {
  WrittenRos2Bag bag = begun();
  bag.message("/cam0/image_raw", 1, cdrImage(kBagStart, pictureOf(0)));
  expectRefused(InputFault::kEmpty, "topic /cam1/image_raw: has no image");
}

TEST_F(ImportBag, AnImuWithoutASampleIsToldSo) {
  WrittenRos2Bag bag = begun();
  bag.message("/cam0/image_raw", 1, cdrImage(kBagStart, pictureOf(0)));
  request_.camera_topics = {"/cam0/image_raw"};
  expectRefused(InputFault::kNoImuSamples, "topic /imu0: has no sample");
}

TEST_F(ImportBag, TheRecordingStaysAsItWas) {
  filled();
  const std::string before = contentOfFile(folder_.path("bag.db3"));
  fs::permissions(folder_.path("bag.db3"), fs::perms::owner_read);
  import();
  EXPECT_EQ(contentOfFile(folder_.path("bag.db3")), before);
  EXPECT_FALSE(fs::exists(folder_.path("bag.db3-wal")));
  EXPECT_FALSE(fs::exists(folder_.path("bag.db3-shm")));
}

}  // namespace
}  // namespace plumbline
