// SPDX-License-Identifier: BSD-3-Clause
// User time of the AprilGrid detector on image files, one thread: detector_benchmark FILE...
#include <ctime>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/target/detector.h"
#include "datasets/images/image_io.h"

namespace {

/// Processor time of this process [s].
double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

int run(const std::vector<std::string>& paths) {
  std::vector<plumbline::GrayImage> images;
  for (const std::string& path : paths) images.push_back(plumbline::readGrayImage(path));
  const plumbline::AprilGridDetector detector(plumbline::AprilGrid{});
  constexpr int kRepetitions = 5;
  std::size_t tags = 0;
  const double start = processorSeconds();
  for (int i = 0; i < kRepetitions; ++i) {
    for (const plumbline::GrayImage& image : images) {
      tags += detector.detect(image.view()).tags.size();
    }
  }
  const double per_image =
      (processorSeconds() - start) / (kRepetitions * static_cast<double>(images.size()));
  fmt::print("{} images, {} tags: {:.2f} ms an image, {:.0f} images a second and core\n",
             images.size(), tags / kRepetitions, 1e3 * per_image, 1 / per_image);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: detector_benchmark FILE...  (PNG or JPEG images of a 6 x 6 grid)\n");
    return 2;
  }
  try {
    return run({argv + 1, argv + argc});
  } catch (const plumbline::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
