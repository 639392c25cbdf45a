// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/pixels.h"

#include <string>
#include <variant>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

ImageMessage image(std::uint32_t width, std::uint32_t height, const std::string& encoding,
                   std::string_view data, std::uint32_t step) {
  ImageMessage m;
  m.width = width;
  m.height = height;
  m.encoding = encoding;
  m.data = data;
  m.step = step;
  return m;
}

GrayImage grayOf(const ImageMessage& m) { return std::get<GrayImage>(grayPixels(m).value()); }

TEST(Pixels, GreyOnesAreThemselvesWithoutWhatFillsTheRows) {
  const std::string data = {1, 2, 3, 99, 4, 5, 6, 99};
  for (const char* encoding : {"mono8", "8UC1"}) {
    const GrayImage out = grayOf(image(3, 2, encoding, data, 4));
    EXPECT_EQ(out.at(2, 0), 3);
    EXPECT_EQ(out.at(0, 1), 4);
  }
  // The last row may end with its pixels.
  EXPECT_TRUE(grayPixels(image(3, 2, "mono8", std::string_view(data).substr(0, 7), 4)));
}

TEST(Pixels, SixteenBitsKeepAllInEitherByteOrder) {
  const std::string data = {0x12, 0x34, 0x56, 0x78};
  ImageMessage m = image(2, 1, "mono16", data, 4);
  EXPECT_EQ(std::get<DeepGrayImage>(grayPixels(m).value()).samples,
            (std::vector<std::uint16_t>{0x3412, 0x7856}));
  m.big_endian = true;
  EXPECT_EQ(std::get<DeepGrayImage>(grayPixels(m).value()).samples,
            (std::vector<std::uint16_t>{0x1234, 0x5678}));
}

TEST(Pixels, ColoursBecomeLumaWhateverTheirOrder) {
  const std::string rgb = {100, 50, 10}, bgr = {10, 50, 100};
  const int luma = 60;  // 0.299 * 100 + 0.587 * 50 + 0.114 * 10 = 60.39
  EXPECT_EQ(grayOf(image(1, 1, "rgb8", rgb, 3)).at(0, 0), luma);
  EXPECT_EQ(grayOf(image(1, 1, "rgba8", rgb + '\7', 4)).at(0, 0), luma);
  for (const char* encoding : {"bgr8", "8UC3"}) {
    EXPECT_EQ(grayOf(image(1, 1, encoding, bgr, 3)).at(0, 0), luma);
  }
  for (const char* encoding : {"bgra8", "8UC4"}) {
    EXPECT_EQ(grayOf(image(1, 1, encoding, bgr + '\7', 4)).at(0, 0), luma);
  }
}

TEST(Pixels, OfYuvTheLumaIsTaken) {
  const std::string uyvy = {9, 1, 8, 2}, yuyv = {1, 9, 2, 8};
  for (const char* encoding : {"yuv422", "uyvy"}) {
    EXPECT_EQ(grayOf(image(2, 1, encoding, uyvy, 4)).at(1, 0), 2);
  }
  for (const char* encoding : {"yuv422_yuy2", "yuyv"}) {
    EXPECT_EQ(grayOf(image(2, 1, encoding, yuyv, 4)).at(1, 0), 2);
  }
}

/// What a sensor behind this pattern records of a picture of one colour; `pattern`: the colours of
/// the pixels (0, 0), (1, 0), (0, 1), (1, 1).
std::string mosaic(const std::string& pattern, int width, int height, int red, int green,
                   int blue) {
  std::string data;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const char colour = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
      data.push_back(static_cast<char>(colour == 'r' ? red : colour == 'g' ? green : blue));
    }
  }
  return data;
}

TEST(Pixels, OneColourBehindAnyBayerPatternIsEvenUpToTheBorder) {
  for (const char* pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    const std::string data = mosaic(pattern, 7, 5, 40, 20, 80);
    const GrayImage out = grayOf(image(7, 5, "bayer_" + std::string(pattern) + "8", data, 7));
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 7; ++x) EXPECT_EQ(out.at(x, y), 40) << pattern << x << "," << y;
    }
  }
}

// A corner would move by the shift of an edge.
TEST(Pixels, TheFilterOfBayerPatternsMovesNoEdge) {
  const int width = 12, height = 4;
  std::string data;
  for (int i = 0; i < width * height; ++i) data.push_back(i % width < 6 ? '\0' : '\x40');
  const GrayImage out = grayOf(image(width, height, "bayer_rggb8", data, width));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      EXPECT_EQ(out.at(x, y) + out.at(width - 1 - x, y), 0x40);  // symmetric about x = 5.5
    }
  }
}

TEST(Pixels, WhatDoesNotFitIsNone) {
  const std::string data(12, 'a');
  EXPECT_FALSE(grayPixels(image(4, 3, "mono8", data, 3)));        // rows shorter than their pixels
  EXPECT_FALSE(grayPixels(image(4, 4, "mono8", data, 4)));        // a row too few
  EXPECT_FALSE(grayPixels(image(4, 3, "rgb8", data, 4)));         // three bytes a pixel
  EXPECT_FALSE(grayPixels(image(0, 3, "mono8", data, 4)));        // nothing
  EXPECT_FALSE(grayPixels(image(1, 3, "bayer_rggb8", data, 4)));  // no mosaic
  EXPECT_FALSE(grayPixels(image(4, 3, "32FC1", data, 4)));
  EXPECT_FALSE(isKnownEncoding("32FC1"));
  EXPECT_FALSE(grayPixels(image(0xffffffff, 0xffffffff, "mono8", data, 0xffffffff)));
}

}  // namespace
}  // namespace plumbline
