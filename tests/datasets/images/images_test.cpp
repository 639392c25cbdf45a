// SPDX-License-Identifier: BSD-3-Clause
// Image files, their hashes, and the cache of corners.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>
#include <png.h>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "datasets/images/image_io.h"
#include "datasets/session/corner_cache.h"
#include "datasets/session/session_reader.h"
#include "tests/datasets/refusal.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

class Images : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("plumbline_images_" + std::to_string(getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const std::string& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
  }
  static GrayImage gradient() {
    GrayImage image(64, 48);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) image.at(x, y) = static_cast<std::uint8_t>(3 * x + y);
    }
    return image;
  }

  fs::path folder_;
};

/// `channels` 4: inks, each with the image's levels.
void writeJpeg(const std::string& file, const GrayImage& image, int channels = 1) {
  std::FILE* out = std::fopen(file.c_str(), "wb");
  ASSERT_NE(out, nullptr);
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  jpeg_stdio_dest(&info, out);
  info.image_width = static_cast<JDIMENSION>(image.width());
  info.image_height = static_cast<JDIMENSION>(image.height());
  info.input_components = channels;
  info.in_color_space = channels == 4 ? JCS_CMYK : JCS_GRAYSCALE;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 95, TRUE);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    std::vector<JSAMPLE> levels;
    for (int x = 0; x < channels * image.width(); ++x) {
      levels.push_back(image.row(static_cast<int>(info.next_scanline))[x / channels]);
    }
    JSAMPROW row = levels.data();
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::fclose(out);
}

/// A grey PNG of 16 bits; `bits`: what its sBIT states, 0: it has none.
void writeDeepPng(const std::string& file, const std::vector<std::uint16_t>& samples, int bits) {
  std::FILE* out = std::fopen(file.c_str(), "wb");
  ASSERT_NE(out, nullptr);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, out);
  png_set_IHDR(png, info, static_cast<png_uint_32>(samples.size()), 1, 16, PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_color_8 stated{};
  stated.gray = static_cast<png_byte>(bits);
  if (bits > 0) png_set_sBIT(png, info, &stated);
  png_write_info(png, info);
  std::vector<png_byte> row;
  for (const std::uint16_t sample : samples) {
    row.push_back(static_cast<png_byte>(sample >> 8));
    row.push_back(static_cast<png_byte>(sample & 0xFF));
  }
  png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
}

// A camera's 10 bits in 16 are not dark: what they use is the range. All 16 in use stay as they
// were, their upper 8; noise of a dark image is not drawn out.
TEST_F(Images, OfSixteenBitsThoseInUseAreTaken) {
  struct Case {
    std::vector<std::uint16_t> samples;
    int stated, bits;
    std::vector<int> grey;
  };
  const std::vector<Case> cases{
      {{0, 512, 1020}, 0, 10, {0, 128, 254}},     {{0, 2048, 4095}, 0, 12, {0, 128, 255}},
      {{0, 512, 1020}, 12, 12, {0, 32, 64}},      {{0, 32768, 65535}, 0, 16, {0, 128, 255}},
      {{0, 32768, 65472}, 10, 16, {0, 128, 255}}, {{0, 1, 3}, 0, 8, {0, 1, 3}}};
  for (const Case& c : cases) {
    writeDeepPng(path("a.png"), c.samples, c.stated);
    const GrayImage image = readGrayImage(path("a.png"));
    EXPECT_EQ(bitsOfDeepImage(path("a.png")), c.bits);
    for (int x = 0; x < 3; ++x) {
      EXPECT_EQ(int{image.data()[x]}, c.grey[static_cast<std::size_t>(x)]) << c.bits << " " << x;
    }
  }
  const std::string whole = read(path("a.png"));
  write(path("cut"), whole.substr(0, whole.size() - 20));
  EXPECT_EQ(faultOf([&] { (void)readGrayImage(path("cut")); }), InputFault::kSyntax);
  writePng(path("b.png"), gradient());
  EXPECT_EQ(bitsOfDeepImage(path("b.png")), std::nullopt);
}

TEST_F(Images, PngComesBackBitForBit) {
  const GrayImage image = gradient();
  writePng(path("a.png"), image);
  const GrayImage again = readGrayImage(path("a.png"));
  ASSERT_EQ(again.width(), 64);
  ASSERT_EQ(again.height(), 48);
  EXPECT_TRUE(std::equal(image.data(), image.data() + 64 * 48, again.data()));
}

TEST_F(Images, AQuickPngIsTheSameImage) {
  writePng(path("a.png"), gradient());
  writePng(path("quick.png"), gradient(), PngEffort::kFast);
  EXPECT_NE(read(path("quick.png")), read(path("a.png")));
  const GrayImage a = readGrayImage(path("a.png")), quick = readGrayImage(path("quick.png"));
  ASSERT_EQ(quick.width(), a.width());
  EXPECT_TRUE(std::equal(a.data(), a.data() + 64 * 48, quick.data()));
}

TEST_F(Images, JpegComesBackNearly) {
  const GrayImage image = gradient();
  writeJpeg(path("a.jpg"), image);
  const GrayImage again = readGrayImage(path("a.jpg"));
  ASSERT_EQ(again.width(), 64);
  for (int i = 0; i < 64 * 48; ++i) ASSERT_NEAR(again.data()[i], image.data()[i], 6) << i;
}

TEST_F(Images, AWholeJpegOfInksIsNotCalledDamaged) {
  writeJpeg(path("a.jpg"), gradient(), 4);
  EXPECT_EQ(faultOf([&] { (void)readGrayImage(path("a.jpg")); }), InputFault::kUnsupported);
}

TEST_F(Images, KindIsToldByContentNotByName) {
  writePng(path("a.png"), gradient());
  fs::rename(path("a.png"), path("a.jpg"));
  EXPECT_EQ(readGrayImage(path("a.jpg")).width(), 64);
}

TEST_F(Images, DamagedFilesAreNamed) {
  writePng(path("a.png"), gradient());
  writeJpeg(path("a.jpg"), gradient());
  for (const char* name : {"a.png", "a.jpg"}) {
    const std::string whole = read(path(name));
    for (double share : {0.02, 0.3, 0.7}) {
      write(path("cut"), whole.substr(0, static_cast<std::size_t>(share * whole.size())));
      EXPECT_EQ(faultOf([&] { (void)readGrayImage(path("cut")); }), InputFault::kSyntax)
          << name << " cut at " << share;
    }
  }
  write(path("empty"), "");
  EXPECT_EQ(faultOf([&] { (void)readGrayImage(path("empty")); }), InputFault::kSyntax);
  write(path("text"), "hello");
  EXPECT_EQ(faultOf([&] { (void)readGrayImage(path("text")); }), InputFault::kSyntax);
  EXPECT_EQ(faultOf([&] { (void)readGrayImage(path("none")); }), InputFault::kMissingFile);
}

TEST_F(Images, CacheReturnsWhatItWasGiven) {
  writePng(path("a.png"), gradient());
  const CornerCache cache(path("cache"), AprilGrid{}, DetectorOptions{});
  const std::string key = cache.keyOf(path("a.png"));
  EXPECT_FALSE(cache.find(key));
  Detection detection;
  detection.corners = {{3, {1.0 / 3, 2e-17}}, {143, {-0.5, 479.25}}};
  cache.store(key, detection);
  const auto found = cache.find(key);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->corners.size(), 2u);
  EXPECT_EQ(found->corners[0].uv, detection.corners[0].uv);
  EXPECT_EQ(found->corners[1].id, 143);
  EXPECT_FALSE(found->spacing);
  detection.spacing = 0.31;
  cache.store(key, detection);
  EXPECT_EQ(cache.find(key).value().spacing, detection.spacing);
}

TEST_F(Images, CacheKeyFollowsImageTargetAndOptions) {
  writePng(path("a.png"), gradient());
  writePng(path("b.png"), GrayImage(64, 48, 7));
  const CornerCache cache(path("cache"), AprilGrid{}, DetectorOptions{});
  EXPECT_NE(cache.keyOf(path("a.png")), cache.keyOf(path("b.png")));
  AprilGrid wider;
  wider.cols = 7;
  EXPECT_NE(cache.keyOf(path("a.png")),
            CornerCache(path("cache"), wider, DetectorOptions{}).keyOf(path("a.png")));
  DetectorOptions options;
  options.min_edge_px = 9;
  EXPECT_NE(cache.keyOf(path("a.png")),
            CornerCache(path("cache"), AprilGrid{}, options).keyOf(path("a.png")));
}

TEST_F(Images, DamagedCacheEntryCountsAsAbsent) {
  writePng(path("a.png"), gradient());
  const CornerCache cache(path("cache"), AprilGrid{}, DetectorOptions{});
  const std::string key = cache.keyOf(path("a.png"));
  Detection detection;
  detection.corners = {{0, {1, 2}}, {1, {3, 4}}};
  cache.store(key, detection);
  for (const auto& entry : fs::recursive_directory_iterator(path("cache"))) {
    if (entry.is_regular_file()) fs::resize_file(entry.path(), entry.file_size() - 5);
  }
  EXPECT_FALSE(cache.find(key));
}

TEST_F(Images, InputHashFollowsContentNotPlace) {
  for (const char* name : {"one", "two"}) {
    fs::create_directories(path(name) + "/cam0");
    write(path(name) + "/cam0/corners.csv", "1,2,3,4\n");
    write(path(name) + "/target.yaml", "tagSize: 0.088\n");
  }
  EXPECT_EQ(inputHash(path("one")), inputHash(path("two")));
  write(path("two") + "/target.yaml", "tagSize: 0.080\n");
  EXPECT_NE(inputHash(path("one")), inputHash(path("two")));
  SessionReadOptions other_target;
  other_target.target_path = path("two") + "/target.yaml";
  EXPECT_NE(inputHash(path("one")), inputHash(path("one"), other_target));
  EXPECT_THAT(inputHash(path("one")), testing::StartsWith("xxh64:"));
  // A calibration that is given is input too.
  write(path("cameras.yaml"), "cam0: 1\n");
  const std::string with = inputHash(path("one"), {}, {path("cameras.yaml")});
  EXPECT_NE(with, inputHash(path("one")));
  write(path("cameras.yaml"), "cam0: 2\n");
  EXPECT_NE(with, inputHash(path("one"), {}, {path("cameras.yaml")}));
}

}  // namespace
}  // namespace plumbline
