// SPDX-License-Identifier: BSD-3-Clause
// png_regions FILE: for every rectangle "x y width height" read from standard input prints the
// share of its pixels that differ from its most frequent colour, and a hash of its pixels. For the
// browser test, which must not decode megapixels in Python.
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <unordered_map>
#include <vector>

#include <png.h>

namespace {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

bool read(const char* path, Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path)) return false;
  png.format = PNG_FORMAT_RGB;
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  image.width = static_cast<int>(png.width);
  image.height = static_cast<int>(png.height);
  return png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr) != 0;
}

}  // namespace

int main(int argc, char** argv) {
  Image image;
  if (argc != 2 || !read(argv[1], image)) {
    std::fprintf(stderr, "png_regions: cannot read the image\n");
    return 2;
  }
  double left = 0, top = 0, width = 0, height = 0;
  while (std::cin >> left >> top >> width >> height) {
    std::unordered_map<std::uint32_t, std::size_t> colours;
    std::uint64_t hash = 1469598103934665603ULL;
    std::size_t total = 0, most = 0;
    for (int y = static_cast<int>(top); y < static_cast<int>(top + height); ++y) {
      for (int x = static_cast<int>(left); x < static_cast<int>(left + width); ++x) {
        if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
        const auto at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                             static_cast<std::size_t>(x));
        const std::uint32_t colour = static_cast<std::uint32_t>(image.rgb[at]) << 16 |
                                     static_cast<std::uint32_t>(image.rgb[at + 1]) << 8 |
                                     image.rgb[at + 2];
        most = std::max(most, ++colours[colour]);
        hash = (hash ^ colour) * 1099511628211ULL;
        ++total;
      }
    }
    const double share =
        total == 0 ? 0 : 1 - static_cast<double>(most) / static_cast<double>(total);
    std::printf("%zu %.6f %zu %016llx\n", total, share, colours.size(),
                static_cast<unsigned long long>(hash));
  }
  return 0;
}
