// SPDX-License-Identifier: BSD-3-Clause
// Decoders of images.
#include "calibrator/base/image.h"
#include "datasets/images/image_io.h"
#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {
namespace {

// As the program reads images: of the size that sensor.yaml states, compared before decoding. No
// block of 8 fits it.
constexpr Resolution kStated{17, 13};

GrayImage read(const std::string& path) { return readGrayImage(path, kStated); }

/// Gradients and an edge.
GrayImage picture(int step) {
  GrayImage image(kStated.width, kStated.height);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const int level = x > y ? step * x : 255 - step * y;
      image.data()[y * image.width() + x] = static_cast<std::uint8_t>(level);
    }
  }
  return image;
}

std::string pngBytes(const GrayImage& image) {
  const Scratch scratch;
  writePng(scratch.path("image.png"), image);
  return readBytes(scratch.path("image.png"));
}

}  // namespace

Parser png() {
  return {[](const std::string& path) { expectStable(path, read(path), pngBytes, read); },
          [] {
            return std::vector<std::string>{pngBytes(picture(0)), pngBytes(picture(9))};
          },
          {"IHDR", "IDAT", "IEND", "PLTE", "tRNS", "gAMA", "sRGB", "iCCP", "sBIT"}};
}

Parser jpeg() {
  const auto decoded = [](const std::string& path) {
    writeBytes(path + ".again", encodeJpeg(read(path), 90));
    read(path + ".again");
  };
  const auto seeds = [] {
    return std::vector<std::string>{encodeJpeg(picture(0), 90), encodeJpeg(picture(9), 75),
                                    encodeJpeg(picture(13), 100)};
  };
  return {decoded, seeds, {"JFIF", "Exif", "Adobe", "ICC_PROFILE"}};
}

}  // namespace plumbline::fuzz
