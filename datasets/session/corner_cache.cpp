// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/corner_cache.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <xxhash.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// Raise it when the detector finds other corners than before, or the files change their form.
constexpr int kRevision = 7;
constexpr std::string_view kMagic = "plumbline corners 2\n";

// A corner as it lies in a file.
struct StoredCorner {
  std::int64_t id;
  double u, v;
};
static_assert(sizeof(StoredCorner) == 24);

// The spacing in front, of 0 where the image shows none.
std::string encode(const Detection& found) {
  const double spacing = found.spacing.value_or(0);
  std::string body(reinterpret_cast<const char*>(&spacing), sizeof spacing);
  for (const Corner& corner : found.corners) {
    const StoredCorner stored{corner.id, corner.uv.x(), corner.uv.y()};
    body.append(reinterpret_cast<const char*>(&stored), sizeof stored);
  }
  return std::string(kMagic) + contentHash(body) + "\n" + body;
}

std::optional<Detection> decode(std::string_view text) {
  // Written without a flush: what a power failure left of a file fails by its hash.
  const std::size_t head = kMagic.size() + 17;  // magic, hash, newline
  if (text.size() < head || text.substr(0, kMagic.size()) != kMagic) return std::nullopt;
  const std::string_view body = text.substr(head);
  if (text.substr(kMagic.size(), 16) != contentHash(body)) return std::nullopt;
  double spacing = 0;
  if (body.size() % sizeof(StoredCorner) != sizeof spacing) return std::nullopt;
  std::memcpy(&spacing, body.data(), sizeof spacing);
  // Never written: a spacing is above 0, or the 0 that stands for none.
  if (std::signbit(spacing) || !std::isfinite(spacing)) return std::nullopt;
  Detection found;
  if (spacing != 0) found.spacing = spacing;
  for (std::size_t at = sizeof spacing; at < body.size(); at += sizeof(StoredCorner)) {
    StoredCorner stored{};
    std::memcpy(&stored, body.data() + at, sizeof stored);
    if (!std::in_range<int>(stored.id)) return std::nullopt;
    found.corners.push_back({static_cast<int>(stored.id), {stored.u, stored.v}});
  }
  return found;
}

}  // namespace

CornerCache::CornerCache(std::string folder, const AprilGrid& target,
                         const DetectorOptions& options)
    : folder_(std::move(folder)),
      // All that the corners found depend on. "{}" writes every digit of a double, so that no two
      // settings share a key.
      settings_(fmt::format("revision {} grid {}x{} {} {} detector {} {} {} {} {} {} {} {}",
                            kRevision, target.rows, target.cols, target.tag_size, target.spacing,
                            options.border_bits, options.decimation, options.max_hamming,
                            options.min_border_distance_px, options.min_edge_px,
                            options.max_grid_error_px, options.min_contrast, options.min_tags)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_)) {
    throw badInput(
        folder_, {InputFault::kNoCache, "the cache folder cannot be made (" + error.message() + ")",
                  "a writable folder", "give another folder, or none"});
  }
  removeDeadTemporaries(folder_);
}

std::string CornerCache::keyOf(const std::string& image_path) const {
  const MappedFile image(image_path);
  // Settings by the seed: other ones give other keys for the same image.
  const std::uint64_t seed = XXH64(settings_.data(), settings_.size(), 0);
  const XXH128_hash_t hash = XXH3_128bits_withSeed(image.text().data(), image.text().size(), seed);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string CornerCache::fileOf(const std::string& key) const {
  return folder_ + "/" + key + ".corners";
}

std::optional<Detection> CornerCache::find(const std::string& key) const {
  const std::string path = fileOf(key);
  if (!fs::is_regular_file(path)) return std::nullopt;
  try {
    const MappedFile file(path);
    return decode(file.text());
  } catch (const InputError&) {  // gone or unreadable meanwhile: as if it had never been there
    return std::nullopt;
  }
}

void CornerCache::store(const std::string& key, const Detection& found) const {
  try {
    writeFileAtomically(fileOf(key), encode(found));
  } catch (const InputError&) {  // see the header: the work goes on without
  }
}

}  // namespace plumbline
