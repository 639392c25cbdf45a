// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/input_hashes.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <sys/stat.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// A file may be written twice within a tick of its file system's clock: what changed so lately is
// read again next time.
constexpr std::int64_t kSettledNs = 2'000'000'000;

BadInput unreadable(const fs::path& path, const std::string& why) {
  return badInput(path.string(), {InputFault::kMissingFile, why, "a readable file or folder"});
}

bool isHidden(const fs::path& path) { return path.filename().string().front() == '.'; }

/// The files below `path` (itself, if it is one), relative to it; sorted, as folders list them in
/// an order of their own. Links are followed: a study may be a folder of links to its recordings.
std::vector<fs::path> filesBelow(const fs::path& path) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(path, error)) return {""};
  auto it = fs::recursive_directory_iterator(path, fs::directory_options::follow_directory_symlink,
                                             error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (isHidden(it->path())) {
      it.disable_recursion_pending();
    } else if (!it->is_directory(error)) {
      files.push_back(it->path().lexically_relative(path));
    }
  }
  if (error) throw unreadable(path, error.message());
  std::ranges::sort(files);
  return files;
}

std::int64_t nanoseconds(const timespec& time) {
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

struct Stamp {
  std::string hash;
  std::int64_t newest_ns = 0;
};

/// The inode is in it for a file that was replaced by one of the same size and time (rename), the
/// time of the inode's change for one that was written in place and given its earlier time.
Stamp stampWithTime(const fs::path& path) {
  std::string text;
  Stamp stamp;
  for (const fs::path& file : filesBelow(path)) {
    struct stat status {};
    const fs::path full = file.empty() ? path : path / file;
    if (::stat(full.c_str(), &status) != 0) throw unreadable(full, "cannot be read");
    const std::int64_t written = nanoseconds(status.st_mtim);
    const std::int64_t changed = nanoseconds(status.st_ctim);
    stamp.newest_ns = std::max({stamp.newest_ns, written, changed});
    text += fmt::format("{}\n{} {} {} {}\n", file.string(), status.st_size, written, changed,
                        status.st_ino);
  }
  stamp.hash = contentHash(text);
  return stamp;
}

/// Over paths and contents in sorted order: a file that was renamed counts as changed.
std::string contentOf(const fs::path& path) {
  std::string text;
  for (const fs::path& file : filesBelow(path)) {
    // Each file by itself: the sum over a recording of gigabytes needs no more than one of them
    // mapped.
    const MappedFile mapped((file.empty() ? path : path / file).string());
    text += file.string() + "\n" + contentHash(mapped.text()) + "\n";
  }
  return contentHash(text);
}

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

std::string stampOf(const fs::path& path) { return stampWithTime(path).hash; }

InputHashes::InputHashes(fs::path cache) : cache_(std::move(cache)) {
  std::ifstream file(cache_);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    Hashed hashed;
    std::string path;
    // The path comes last, as it may hold blanks. What cannot be read is hashed anew.
    if (words >> hashed.content >> hashed.stamp && words.get() == ' ' &&
        std::getline(words, path)) {
      known_[path] = hashed;
    }
  }
}

InputHashes::Hashed InputHashes::of(const fs::path& path) {
  // Once a night: all steps of a recording are then of one state of it, and whether it still is in
  // that state every step checks for itself.
  const auto seen = seen_.find(path.string());
  if (seen != seen_.end()) return seen->second;
  // Before the contents: what is written between the two is noticed by the stamp.
  const Stamp stamp = stampWithTime(path);
  const auto known = known_.find(path.string());
  Hashed hashed;
  if (known != known_.end() && known->second.stamp == stamp.hash) {
    hashed = known->second;
  } else {
    hashed = {contentOf(path), stamp.hash};
  }
  if (nowNs() - stamp.newest_ns > kSettledNs) {
    known_[path.string()] = hashed;
  } else {
    known_.erase(path.string());
  }
  return seen_[path.string()] = hashed;
}

void InputHashes::save() const {
  std::string text;
  for (const auto& [path, hashed] : known_) {
    // Only what this night asked for, so that the cache does not grow for ever. The format has one
    // line a path.
    if (seen_.count(path) > 0 && path.find('\n') == std::string::npos) {
      text += fmt::format("{} {} {}\n", hashed.content, hashed.stamp, path);
    }
  }
  writeFileAtomically(cache_.string(), text);
}

}  // namespace plumbline
