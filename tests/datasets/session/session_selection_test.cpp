// SPDX-License-Identifier: BSD-3-Clause
// Which part of a recording is read, and which of its files: the interval, its IMU samples, whose
// word counts where two files state the same, and what the input's hash covers.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "datasets/session/session_reader.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/session/session_files.h"

namespace plumbline {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;
constexpr TimeNs kStart = 1'400'000'000 * kSecond;

/// Ten seconds of one camera at 2 Hz from kStart on, and of an IMU at 10 Hz that ran three seconds
/// before.
class Selection : public testing::Test {
 protected:
  Selection() {
    writeGoodSession(folder_);
    std::filesystem::remove_all(folder_.path("cam1"));
    std::string corners = "#timestamp [ns],corner_id,u [px],v [px]\n";
    for (int i = 0; i <= 20; ++i) {
      corners += std::to_string(kStart + i * kSecond / 2) + ",0,100,200\n";
    }
    folder_.write("cam0/corners.csv", corners);
    std::string samples = "#timestamp [ns],wx,wy,wz,ax,ay,az\n";
    for (int i = -30; i <= 100; ++i) {
      samples += std::to_string(kStart + i * kSecond / 10) + ",0,0,0,0,0,9.8\n";
    }
    folder_.write("imu0/data.csv", samples);
  }
  Session read() const { return readSession(folder_.path(), options_); }
  void expectSizes(std::size_t views, std::size_t samples) const {
    const Session session = read();
    EXPECT_EQ(session.cameras[0].views.size(), views);
    EXPECT_EQ(session.imu->samples.size(), samples);
  }

  TemporaryFolder folder_;
  SessionReadOptions options_;
};

// 4 s to 6 s, both ends included; the IMU reaches a margin further on both sides, as the time
// offset may move it.
TEST_F(Selection, TheImuReachesBeyondTheFramesByItsMargin) {
  options_.from_s = 4;
  options_.to_s = 6;
  options_.imu_margin_s = 1.5;
  const Session session = read();
  const auto& views = session.cameras[0].views;
  ASSERT_EQ(views.size(), 5U);
  EXPECT_EQ(views.front().t, kStart + 4 * kSecond);
  EXPECT_EQ(views.back().t, kStart + 6 * kSecond);
  const auto& samples = session.imu->samples;
  ASSERT_EQ(samples.size(), 51U);  // 2.5 s to 7.5 s
  EXPECT_EQ(samples.front().t, kStart + 5 * kSecond / 2);
  EXPECT_EQ(samples.back().t, kStart + 15 * kSecond / 2);
}

TEST_F(Selection, AStrideAloneKeepsEverySample) {
  options_.stride = 4;
  options_.imu_margin_s = 0;
  expectSizes(6, 131);
}

TEST_F(Selection, AnOpenEndReachesToTheLast) {
  options_.from_s = 9;
  options_.imu_margin_s = 0;
  expectSizes(3, 11);
}

TEST_F(Selection, WithoutTheImuNoneIsRead) {
  options_.read_imu = false;
  EXPECT_FALSE(read().imu);
}

// ---- whose word counts

// The option stands for cameras that do not say; corners beyond what sensor.yaml says are refused.
TEST_F(Selection, SensorYamlGoesBeforeTheOptionsResolution) {
  options_.resolution = Resolution{4000, 3000};
  EXPECT_EQ(read().cameras[0].resolution, (Resolution{752, 480}));
  std::filesystem::remove(folder_.path("cam0/sensor.yaml"));
  EXPECT_EQ(read().cameras[0].resolution, (Resolution{4000, 3000}));
}

TEST_F(Selection, ImuYamlGoesBeforeEurocsSensorFile) {
  folder_.write("imu0/sensor.yaml",
                "sensor_type: imu\nrate_hz: 100\ngyroscope_noise_density: 1.0e-4\n"
                "gyroscope_random_walk: 1.0e-5\naccelerometer_noise_density: 4.0e-3\n"
                "accelerometer_random_walk: 1.0e-3\n");
  EXPECT_EQ(read().imu->noise.accel_density, 2e-3);
  options_.imu_path = folder_.path("imu0/sensor.yaml");
  EXPECT_EQ(read().imu->noise.accel_density, 4e-3);
}

// rate_hz is EuRoC's word, update_rate Kalibr's, which the program's own files have.
TEST_F(Selection, OfTwoWordsForTheRateKalibrsCounts) {
  folder_.write("imu.yaml", kImuYamlText + "rate_hz: 1000\n");
  EXPECT_EQ(read().imu->noise.rate_hz, 200);
}

// ---- the hash

TEST_F(Selection, TheHashFollowsEveryFileThatIsRead) {
  folder_.write("cam0/data.csv",
                "#timestamp [ns],filename\n" + std::to_string(kStart) + ",a.png\n");
  const std::string before = inputHash(folder_.path());
  for (const char* name : {"target.yaml", "imu.yaml", "imu0/data.csv", "cam0/sensor.yaml",
                           "cam0/corners.csv", "cam0/data.csv"}) {
    const std::string kept = folder_.path(std::string(name) + ".kept");
    std::filesystem::copy_file(folder_.path(name), kept);
    std::ofstream(folder_.path(name), std::ios::app) << "# a comment\n";
    EXPECT_NE(inputHash(folder_.path()), before) << name;
    std::filesystem::rename(kept, folder_.path(name));
    EXPECT_EQ(inputHash(folder_.path()), before) << name;
  }
  folder_.write("notes.txt", "of the operator");
  EXPECT_EQ(inputHash(folder_.path()), before);
}

TEST_F(Selection, ACamerasHashFollowsWhatItRecordedAlone) {
  const std::vector<std::string> before = cameraHashes(folder_.path());
  ASSERT_EQ(before.size(), 1U);
  for (const char* name : {"target.yaml", "imu.yaml", "imu0/data.csv", "cam0/sensor.yaml"}) {
    std::ofstream(folder_.path(name), std::ios::app) << "# a comment\n";
  }
  EXPECT_EQ(cameraHashes(folder_.path()), before);
  std::filesystem::rename(folder_.path("cam0"), folder_.path("cam7"));
  EXPECT_EQ(cameraHashes(folder_.path()), before) << "under another name";
  std::ofstream(folder_.path("cam7/corners.csv"), std::ios::app) << "# a comment\n";
  EXPECT_NE(cameraHashes(folder_.path()), before);
  folder_.write("cam7/corners.csv", "#timestamp [ns],corner_id,u [px],v [px]\n");
  EXPECT_TRUE(cameraHashes(folder_.path()).empty())
      << "who saw nothing is like all others that did";
}

TEST_F(Selection, TheHashLeavesOutAnImuThatIsNotRead) {
  options_.read_imu = false;
  const std::string before = inputHash(folder_.path(), options_);
  std::ofstream(folder_.path("imu0/data.csv"), std::ios::app) << "# a comment\n";
  EXPECT_EQ(inputHash(folder_.path(), options_), before);
}

}  // namespace
}  // namespace plumbline
