// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/corner_cache.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "datasets/content_hash.h"
#include "datasets/internal/mapped_file.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr int kDetectorRevision = 1;  // raise it whenever the detector's results change
constexpr char kMagic[8] = {'P', 'L', 'C', 'O', 'R', 'N', '1', '\n'};

struct Entry {
  std::int64_t id;
  double u, v;
};

std::string settingsText(const AprilGrid& target, const DetectorOptions& o) {
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", kDetectorRevision, target.rows,
                     target.cols, target.tag_size, target.spacing, o.border_bits, o.decimation,
                     o.max_hamming, o.min_border_distance_px, o.min_edge_px, o.max_grid_error_px,
                     o.min_tags);
}

fs::path entryPath(const std::string& folder, const std::string& key) {
  return fs::path(folder) / key.substr(0, 2) / (key.substr(2) + ".corners");
}

}  // namespace

CornerCache::CornerCache(std::string folder, const AprilGrid& target,
                         const DetectorOptions& options)
    : folder_(std::move(folder)), settings_(settingsText(target, options)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    throw InputError(folder_, 0,
                     "cannot be made: " + error.message() + "; give --cache another folder");
  }
}

std::string CornerCache::keyOf(const std::string& image_path) const {
  const MappedFile image(image_path);
  ContentHash hash;
  hash.add(settings_);
  hash.add(image.text());
  return hash.hex();
}

std::optional<std::vector<Corner>> CornerCache::find(const std::string& key) const {
  std::ifstream file(entryPath(folder_, key), std::ios::binary);
  if (!file) return std::nullopt;
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::uint64_t count = 0;
  constexpr std::size_t kHead = sizeof kMagic + sizeof count;
  if (bytes.size() < kHead || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0) {
    return std::nullopt;
  }
  std::memcpy(&count, bytes.data() + sizeof kMagic, sizeof count);
  if ((bytes.size() - kHead) / sizeof(Entry) != count ||
      (bytes.size() - kHead) % sizeof(Entry) != 0) {
    return std::nullopt;
  }
  std::vector<Corner> corners(count);
  for (std::size_t i = 0; i < count; ++i) {
    Entry entry;
    std::memcpy(&entry, bytes.data() + kHead + i * sizeof entry, sizeof entry);
    corners[i] = {static_cast<int>(entry.id), {entry.u, entry.v}};
  }
  return corners;
}

void CornerCache::store(const std::string& key, const std::vector<Corner>& corners) const {
  const fs::path path = entryPath(folder_, key);
  const fs::path temporary =
      path.string() +
      fmt::format(".{}.{}.tmp", getpid(), std::hash<std::thread::id>()(std::this_thread::get_id()));
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  std::ofstream file(temporary, std::ios::binary);
  const std::uint64_t count = corners.size();
  file.write(kMagic, sizeof kMagic);
  file.write(reinterpret_cast<const char*>(&count), sizeof count);
  for (const Corner& corner : corners) {
    const Entry entry{corner.id, corner.uv.x(), corner.uv.y()};
    file.write(reinterpret_cast<const char*>(&entry), sizeof entry);
  }
  file.close();
  if (file) {
    fs::rename(temporary, path, ignored);
  } else {
    fs::remove(temporary, ignored);
  }
}

}  // namespace plumbline
