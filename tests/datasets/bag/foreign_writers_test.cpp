// SPDX-License-Identifier: BSD-3-Clause
// Recordings that none of our writers made: fixtures/make_fixtures.mjs says which did.
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/bag/bag.h"
#include "datasets/bag/import_bag.h"
#include "datasets/bag/messages.h"
#include "datasets/bag/pixels.h"
#include "datasets/images/image_io.h"
#include "datasets/session/session_reader.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

constexpr TimeNs kFirst = 1'700'000'000'000'000'000;
constexpr TimeNs kFrameInterval = 50'000'000, kSampleInterval = 25'000'000;  // [ns]

std::string fixture(const std::string& name) {
  return PLUMBLINE_SOURCE_DIR "/tests/datasets/bag/fixtures/" + name;
}

std::vector<int> levelsOf(int camera, int frame) {
  std::vector<int> levels;
  for (int i = 0; i < 6 * 4; ++i) levels.push_back((60 * camera + 30 * frame + 5 * i) % 256);
  return levels;
}

std::vector<int> levelsIn(const GrayImage& image) {
  return {image.data(), image.data() + image.width() * image.height()};
}

ImuSample statedSample(int i) {
  return {kFirst + i * kSampleInterval, {i / 8.0, -0.1, 1e-9}, {i / 10.0, -9.81, double(i)}};
}

void expectSame(const ImuSample& read, const ImuSample& stated) {
  EXPECT_EQ(read.t, stated.t);
  EXPECT_EQ(read.gyro, stated.gyro);
  EXPECT_EQ(read.accel, stated.accel);
}

class ForeignWriters : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Recordings, ForeignWriters,
                         testing::Values("chunked_lz4.mcap", "chunked_zstd.mcap", "unchunked.mcap",
                                         "no_summary.mcap", "no_summary_unchunked.mcap",
                                         "no_statistics.mcap", "ros1.mcap", "split", "sqlite"),
                         [](const auto& info) {
                           const std::string name = info.param;
                           return name.substr(0, name.find('.'));
                         });

TEST_P(ForeignWriters, TopicsHaveTheirTypesAndCounts) {
  std::vector<std::string> told;
  for (const BagTopic& topic : topicsOf({fixture(GetParam())})) {
    told.push_back(topic.name + " " + topic.type + " " + std::to_string(topic.messages));
  }
  std::vector<std::string> stated{
      "/cam0 sensor_msgs/Image 2", "/cam1 sensor_msgs/Image 2", "/cam2 sensor_msgs/Image 2",
      "/cam3/compressed sensor_msgs/CompressedImage 2", "/imu sensor_msgs/Imu 4"};
  const std::string name = GetParam();
  if (name == "chunked_zstd.mcap" || name == "unchunked.mcap")
    stated.push_back("/notes note (json) 1");
  EXPECT_EQ(told, stated);
}

TEST_P(ForeignWriters, TheSessionIsThatWhichTheyWrote) {
  const TemporaryFolder folder;
  BagImport request;
  request.bags = {fixture(GetParam())};
  request.target_path = folder.write(
      "target.yaml",
      "target_type: aprilgrid\ntagRows: 6\ntagCols: 6\ntagSize: 0.088\ntagSpacing: 0.3\n");
  request.imu_path =
      folder.write("imu.yaml",
                   "rostopic: /imu\nupdate_rate: 40\naccelerometer_noise_density: 0.002\n"
                   "accelerometer_random_walk: 0.003\ngyroscope_noise_density: 0.00017\n"
                   "gyroscope_random_walk: 0.00002\n");
  std::filesystem::create_directory(folder.path("session"));
  const auto sensors = importBags(request, folder.path("session"));
  ASSERT_EQ(sensors.size(), 5U);
  const Recording read = readRecording(folder.path("session"));
  for (const int camera : {0, 1, 3}) {
    ASSERT_EQ(read.images[camera].size(), 2U) << camera;
    for (int frame = 0; frame < 2; ++frame) {
      const ImageFile& file = read.images[camera][frame];
      EXPECT_EQ(file.t, kFirst + frame * kFrameInterval);
      EXPECT_EQ(levelsIn(readGrayImage(file.path)), levelsOf(camera, frame)) << file.path;
    }
  }
  ASSERT_EQ(read.session.imu->samples.size(), 4U);
  for (int i = 0; i < 4; ++i) expectSame(read.session.imu->samples[i], statedSample(i));
}

TEST_P(ForeignWriters, SixteenBitsAreThoseWritten) {
  int frame = 0;
  for (const std::string& file : bagFiles(fixture(GetParam()))) {
    openBag(file)->read({"/cam2"}, [&](const BagMessage& message) {
      const auto pixels = grayPixels(decodeImage(message).value());
      const std::vector<int> levels = levelsOf(2, frame++);
      std::vector<int> deep;
      for (const int level : levels) deep.push_back(256 * level + 255 - level);
      EXPECT_THAT(std::get<DeepGrayImage>(pixels.value()).samples, testing::ElementsAreArray(deep));
    });
  }
  EXPECT_EQ(frame, 2);
}

TEST(ForeignCdr, PlainKindsOfBothVersionsAndByteOrdersAreRead) {
  const auto bag = openBag(fixture("kinds_of_cdr.mcap"));
  for (const char* kind : {"/kind0", "/kind1", "/kind6", "/kind7", "/kind16", "/kind17"}) {
    SCOPED_TRACE(kind);
    int told = 0;
    bag->read({std::string(kind) + "/imu"}, [&](const BagMessage& message) {
      expectSame(decodeImu(message).value(), statedSample(1));
      ++told;
    });
    bag->read({std::string(kind) + "/cam"}, [&](const BagMessage& message) {
      const ImageMessage image = decodeImage(message).value();
      EXPECT_EQ(image.t, kFirst);
      EXPECT_EQ(levelsIn(std::get<GrayImage>(grayPixels(image).value())), levelsOf(0, 0));
      ++told;
    });
    EXPECT_EQ(told, 2);
  }
}

}  // namespace
}  // namespace plumbline
