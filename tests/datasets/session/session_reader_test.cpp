// SPDX-License-Identifier: BSD-3-Clause
// What a good session's folder turns into.
#include "datasets/session/session_reader.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/datasets/session/session_files.h"

namespace plumbline {
namespace {

TEST(SessionReader, ReadsEveryPart) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  const Session session = readSession(folder.path());
  ASSERT_EQ(session.cameras.size(), 2U);
  EXPECT_EQ(session.cameras[0].name, "cam0");
  EXPECT_EQ(session.cameras[0].distortion_model, "radtan");
  ASSERT_EQ(session.cameras[0].views.size(), 2U);
  EXPECT_EQ(session.cameras[0].views[0].t, 1400000000000000000);
  EXPECT_EQ(session.cameras[0].views[0].corners[1].uv, Eigen::Vector2d(110.5, 200.25));
  ASSERT_TRUE(session.imu);
  EXPECT_EQ(session.imu->samples[2].accel, Eigen::Vector3d(9.7, 0.5, 0.6));
  EXPECT_EQ(session.imu->noise.gyro_random_walk, 1.9393e-5);
  EXPECT_EQ(session.target.tag_size, 0.088);
}

TEST(SessionReader, Mav0LevelMayBeThereOrGiven) {
  const TemporaryFolder folder;
  writeGoodSession(folder, "mav0/");
  EXPECT_EQ(readSession(folder.path()).cameras.size(), 2U);
  EXPECT_EQ(readSession(folder.path("mav0")).cameras.size(), 2U);
  EXPECT_EQ(readSession(folder.path("mav0")).name, readSession(folder.path()).name);
}

TEST(SessionReader, CamerasComeInNumericOrder) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  for (const char* camera : {"cam10/", "cam2/"}) {
    folder.write(std::string(camera) + "sensor.yaml", kSensorText);
    folder.write(std::string(camera) + "corners.csv", kCornersText);
  }
  std::string names;
  for (const CameraStream& camera : readSession(folder.path()).cameras) names += camera.name + " ";
  EXPECT_EQ(names, "cam0 cam1 cam2 cam10 ");
}

TEST(SessionReader, FramesWithoutCornersAreKeptWhereAListNamesThem) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  folder.write("cam0/data.csv",
               "#timestamp [ns],filename\n1399999999950000000,a.png\n1400000000000000000,b.png\n"
               "1400000000050000000,c.png\n1400000000100000000,d.png\n");
  const Session session = readSession(folder.path());
  ASSERT_EQ(session.cameras[0].views.size(), 4U);
  EXPECT_TRUE(session.cameras[0].views[0].corners.empty());
  EXPECT_EQ(session.cameras[0].views[1].corners.size(), 2U);
  EXPECT_TRUE(session.cameras[0].views[3].corners.empty());
  EXPECT_EQ(session.cameras[1].views.size(), 2U);
}

// Scripts end the last line or do not; beside corners names may be missing.
TEST(SessionReader, AWholeListNeedsNoNewlineAtItsEnd) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  for (const char* rows : {"1400000000000000000,9.png\n1400000000050000000,10.PNG",
                           "1400000000000000000\n1400000000050000000",
                           "1400000000000000000,a_9.pgm\n1400000000050000000,a_10.pgm",
                           "1400000000000000000,a.jpeg"}) {
    folder.write("cam0/data.csv", std::string("#timestamp [ns],filename\n") + rows);
    EXPECT_EQ(readSession(folder.path()).cameras[0].views.size(), 2U) << rows;
  }
}

TEST(SessionReader, ACornersRowMayComeInAnyOrderOfIds) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  folder.write("cam0/corners.csv", "1000000000,7,1,2\r\n1000000000,3,4,5\r\n");  // CRLF, no header
  const ImageView view = readSession(folder.path()).cameras[0].views[0];
  EXPECT_EQ(view.corners[0].id, 3);
  EXPECT_EQ(view.corners[1].uv.y(), 2);
}

TEST(SessionReader, AHeaderThatNamesAccelerationFirstIsHonoured) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  for (const char* comment : {"", "# recorded by a logger\n"}) {
    folder.write("imu0/data.csv", std::string(comment) +
                                      "#timestamp [ns],a_x,a_y,a_z,w_x,w_y,w_z\n"
                                      "1000000000,9.8,1,2,0.1,0.2,0.3\n");
    const ImuSample sample = readSession(folder.path()).imu->samples[0];
    EXPECT_EQ(sample.accel.x(), 9.8) << comment;
    EXPECT_EQ(sample.gyro.x(), 0.1) << comment;
  }
}

// Names of loggers, of MAVLink, and a line that ends in a comma as its rows do.
TEST(SessionReader, AccelerationFirstIsKnownByOtherNamesToo) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  for (const char* names : {"t,ax,ay,az,gx,gy,gz", "time,xacc,yacc,zacc,xgyro,ygyro,zgyro",
                            "#t,imu_acc_x,imu_acc_y,imu_acc_z,imu_gyr_x,imu_gyr_y,imu_gyr_z",
                            "#timestamp [ns],a_x,a_y,a_z,w_x,w_y,w_z,"}) {
    folder.write("imu0/data.csv", std::string(names) + "\n1000000000,9.8,1,2,0.1,0.2,0.3,\n");
    EXPECT_EQ(readSession(folder.path()).imu->samples[0].accel.x(), 9.8) << names;
  }
}

// "az" begins like an acceleration; a header counts only where all six names fit.
TEST(SessionReader, AHeaderOfOtherNamesLeavesTheUsualOrder) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  folder.write("imu0/data.csv", "#t,ax,ay,az,x,y,z\n1000000000,0.1,0.2,0.3,9.8,1,2\n");
  EXPECT_EQ(readSession(folder.path()).imu->samples[0].gyro.x(), 0.1);
}

TEST(SessionReader, NoiseMayBeWrappedAsKalibrWritesItOrComeFromEurocsSensorFile) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  std::string wrapped = "imu0:\n  model: calibrated\n  " + kImuYamlText;
  for (std::size_t at = wrapped.find("/imu0\n"); (at = wrapped.find('\n', at)) + 1 < wrapped.size();
       at += 3) {
    wrapped.insert(at + 1, "  ");
  }
  folder.write("imu.yaml", wrapped);
  EXPECT_EQ(readSession(folder.path()).imu->noise.accel_density, 2e-3);
  std::filesystem::remove(folder.path("imu.yaml"));
  folder.write("imu0/sensor.yaml",
               "sensor_type: imu\nrate_hz: 100\ngyroscope_noise_density: 1.0e-4\n"
               "gyroscope_random_walk: 1.0e-5\naccelerometer_noise_density: 4.0e-3\n"
               "accelerometer_random_walk: 1.0e-3\n");
  const ImuNoise noise = readSession(folder.path()).imu->noise;
  EXPECT_EQ(noise.accel_density, 4e-3);
  EXPECT_EQ(noise.rate_hz, 100);
}

TEST(SessionReader, StrideKeepsTheCamerasOfAFrameTogether) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  std::string all = "#timestamp [ns],corner_id,u [px],v [px]\n";
  std::string some = all;  // this camera lost frame 1
  for (int i = 0; i < 6; ++i) {
    const std::string row = std::to_string(1000000000 + i * 50000000) + ",0,1,2\n";
    all += row;
    if (i != 1) some += row;
  }
  folder.write("cam0/corners.csv", all);
  folder.write("cam1/corners.csv", some);
  SessionReadOptions options;
  options.stride = 2;
  const Session session = readSession(folder.path(), options);
  ASSERT_EQ(session.cameras[0].views.size(), 3U);
  ASSERT_EQ(session.cameras[1].views.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(session.cameras[0].views[i].t, session.cameras[1].views[i].t);
  }
  options.stride = 1;
  options.from_s = 0.1;
  options.to_s = 0.2;
  EXPECT_EQ(readSession(folder.path(), options).cameras[0].views.size(), 3U);
  options.from_s = 100;
  options.to_s = 200;
  EXPECT_THROW(readSession(folder.path(), options), InputError);
}

TEST(SessionReader, StridePairsWithinTheGivenTolerance) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  std::string first = "#timestamp [ns],corner_id,u [px],v [px]\n";
  std::string second = first;  // 5 ms later than the first
  for (long long i = 0; i < 6; ++i) {
    const long long t = 1'400'000'000'000'000'000 + i * 50'000'000;
    first += std::to_string(t) + ",0,100,200\n";
    second += std::to_string(t + 5'000'000) + ",0,100,200\n";
  }
  folder.write("cam0/corners.csv", first);
  folder.write("cam1/corners.csv", second);
  SessionReadOptions options;
  options.stride = 2;
  options.sync_tolerance = 6'000'000;
  const Session together = readSession(folder.path(), options);
  ASSERT_EQ(together.cameras[0].views.size(), 3U);
  ASSERT_EQ(together.cameras[1].views.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(together.cameras[1].views[i].t, together.cameras[0].views[i].t + 5'000'000);
  }
  options.sync_tolerance = 4'000'000;  // every view a frame of its own: cam1's are the odd ones
  const Session apart = readSession(folder.path(), options);
  EXPECT_EQ(apart.cameras[0].views.size(), 6U);
  EXPECT_TRUE(apart.cameras[1].views.empty());
}

TEST(SessionReader, ACameraOfImagesIsListedForDetection) {
  const TemporaryFolder folder;
  writeGoodSession(folder);
  std::filesystem::remove(folder.path("cam1/corners.csv"));
  for (const char* name : {"2000000000.png", "1000000000.jpg", "notes.txt"}) {
    folder.write(std::string("cam1/data/") + name, "x");
  }
  // Neither is one: a link that leads nowhere, and a folder whose name has a sign.
  std::filesystem::create_symlink("loop.png", folder.path("cam1/data/loop.png"));
  std::filesystem::create_symlink("cam7", folder.path("cam7"));
  folder.write("cam-1/corners.csv", "");
  const Recording recording = readRecording(folder.path());
  EXPECT_EQ(recording.session.cameras.size(), 2U);
  EXPECT_NO_THROW((void)inputHash(folder.path()));
  ASSERT_EQ(recording.images[1].size(), 2U);
  EXPECT_EQ(recording.images[1][0].t, 1000000000);
  EXPECT_EQ(recording.session.cameras[1].views.size(), 2U);
  EXPECT_TRUE(recording.images[0].empty());
  EXPECT_THROW(readSession(folder.path()), InputError);
}

}  // namespace
}  // namespace plumbline
