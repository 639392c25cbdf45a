// SPDX-License-Identifier: BSD-3-Clause
// Which images a frame of a replay shows.
#include <filesystem>

#include <gtest/gtest.h>

#include "datasets/images/image_io.h"
#include "evaluate/replay/frames.h"
#include "evaluate/replay/replay_session.h"

namespace plumbline {
namespace {

constexpr TimeNs kInterval = 50'000'000;
constexpr TimeNs kShift = 12'000'000;  // of the second camera's clock
constexpr int kFrames = 20;            // enough to tell a constant shift

class ReplayImages : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Two cameras; each image is grey of a level of its own.
  LoadedSession recording() const {
    LoadedSession loaded;
    loaded.session.cameras.resize(2);
    loaded.images.resize(2);
    for (int c = 0; c < 2; ++c) {
      const auto camera = static_cast<std::size_t>(c);
      for (int i = 0; i < kFrames; ++i) {
        const TimeNs t = i * kInterval + c * kShift;
        const std::string path = (folder_ / (std::to_string(c) + std::to_string(i))).string();
        writePng(path + ".png", grey(c, i));
        loaded.session.cameras[camera].views.push_back({t, {}});
        loaded.images[camera].push_back({t, path + ".png"});
      }
    }
    return loaded;
  }

  static GrayImage grey(int camera, int i) {
    GrayImage image(64, 48);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) image.at(x, y) = static_cast<std::uint8_t>(100 * camera + 5 * i);
    }
    return image;
  }

  std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / "replay_images";
};

TEST_F(ReplayImages, AreThoseOfTheFramesViewsThoughAClockIsShifted) {
  LoadedSession loaded = recording();
  loaded.session.cameras[1].views.erase(loaded.session.cameras[1].views.begin() + 3);
  loaded.images[1].erase(loaded.images[1].begin() + 3);
  const std::vector<Frame> paired = pairedFrames(loaded.session);
  ASSERT_EQ(paired.size(), static_cast<std::size_t>(kFrames));
  std::vector<ReplayFrame> frames(paired.size());
  addImages(loaded, paired, frames, 1, [](const std::string&, double) {});
  for (int i = 0; i < kFrames; ++i) {
    const ReplayFrame& frame = frames[static_cast<std::size_t>(i)];
    ASSERT_EQ(frame.jpeg.size(), 2U);
    EXPECT_EQ(frame.jpeg[0], encodeJpeg(grey(0, i), 60)) << i;
    EXPECT_EQ(frame.jpeg[1], i == 3 ? "" : encodeJpeg(grey(1, i), 60)) << i;
  }
}

}  // namespace
}  // namespace plumbline
