// SPDX-License-Identifier: BSD-3-Clause
// Which images of a recording a record keeps.
#include <filesystem>

#include <gtest/gtest.h>

#include "datasets/images/image_io.h"
#include "evaluate/calibration/calibrate_session.h"

namespace plumbline {
namespace {

constexpr int kFrames = 12;

class ViewImages : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    loaded_.session.cameras.resize(2);
    loaded_.images.resize(2);
    for (int i = 0; i < kFrames; ++i) {
      const std::string path = (folder_ / (std::to_string(i) + ".png")).string();
      writePng(path, grey(i));
      loaded_.images[0].push_back({i, path});  // the other camera comes as corners
    }
    CameraStageResult& stage = record_.camera.emplace();
    for (int i = 0; i < kFrames; ++i) {
      stage.frames.push_back({1000 + i, {i, i}});
      for (int camera = 0; camera < 2; ++camera) {
        // Errors grow with the frame; the second camera's are the larger ones of each.
        const float error = 0.1F * static_cast<float>(i + 1) + 0.01F * static_cast<float>(camera);
        stage.residuals.push_back({camera, i, 0, {3, 4}, {error, 0}, true});
      }
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static GrayImage grey(int i) {
    GrayImage image(1640, 8);
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 1640; ++x) image.at(x, y) = static_cast<std::uint8_t>(10 * i);
    }
    return image;
  }

  std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / "view_images";
  LoadedSession loaded_;
  CalibrationRecord record_;
};

TEST_F(ViewImages, AreThoseOfTheWorstViewsThatHaveOne) {
  addViewImages(loaded_, record_);
  // The eight worst views are both cameras' of the last four frames.
  ASSERT_EQ(record_.view_images.size(), 4U);
  for (int k = 0; k < 4; ++k) {
    const ViewImage& image = record_.view_images[static_cast<std::size_t>(k)];
    const int frame = kFrames - 1 - k;
    EXPECT_EQ(image.camera, 0);
    EXPECT_EQ(image.t, 1000 + frame);
    EXPECT_EQ(image.factor, 3);  // 1640 pixels to 800 at most
    EXPECT_EQ(image.jpeg, encodeJpeg(shrunk(grey(frame), 3), 60));
  }
}

TEST_F(ViewImages, AMissingFileLeavesOutItsImageAlone) {
  std::filesystem::remove(folder_ / "10.png");
  addViewImages(loaded_, record_);
  ASSERT_EQ(record_.view_images.size(), 3U);
  EXPECT_EQ(record_.view_images[0].t, 1011);
  EXPECT_EQ(record_.view_images[1].t, 1009);
}

TEST_F(ViewImages, AreNoneOfARecordingOfCorners) {
  loaded_.images[0].clear();
  addViewImages(loaded_, record_);
  EXPECT_TRUE(record_.view_images.empty());
}

// Where the cameras were given there is no stage of their own: the other's views are ranked.
TEST_F(ViewImages, AreThoseOfTheImuStageWhereTheCamerasWereGiven) {
  CameraImuStageResult& stage = record_.camera_imu.emplace();
  for (int i = 0; i < kFrames; ++i) {
    stage.frames.push_back({2000 + i, {kFrames - 1 - i, 0}});  // views in another order
    stage.residuals.push_back({0, i, 0, {3, 4}, {0.1F * static_cast<float>(i), 0}, true});
  }
  record_.camera.reset();
  addViewImages(loaded_, record_);
  ASSERT_EQ(record_.view_images.size(), 8U);
  EXPECT_EQ(record_.view_images[0].t, 2011);
  EXPECT_EQ(record_.view_images[0].jpeg, encodeJpeg(shrunk(grey(0), 3), 60));
  EXPECT_EQ(record_.view_images[7].t, 2004);
}

}  // namespace
}  // namespace plumbline
