// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace plumbline {

/// A whole file mapped read-only into memory: text is parsed where it lies, without a copy.
class MappedFile {
 public:
  /// Throws InputError where the file is missing, a folder or not readable.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view text() const { return {data_, size_}; }

 private:
  const char* data_ = "";
  std::size_t size_ = 0;
};

/// XXH64 of the bytes as 16 hexadecimal digits: the same on every machine. Not for secrets.
std::string contentHash(std::string_view bytes);

/// Writes `content` (text or bytes) to `path`, whole or not at all: under a temporary name in the
/// same folder, then renamed over `path`. The folder must exist. Throws
/// InputError where it cannot be written; the temporary file is then removed and an older `path` is
/// as it was. Safe from several threads and processes: the last writer's content stays.
void writeFileAtomically(const std::string& path, std::string_view content);

/// A folder that is filled under a hidden name of its own beside its final one; gone unless
/// committed, so that a folder of results is complete or not there.
class PendingFolder {
 public:
  /// Throws InputError where the final folder exists and is not empty, or cannot be made.
  explicit PendingFolder(const std::filesystem::path& final_path);
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;
  ~PendingFolder();

  /// Where to write before commit().
  const std::filesystem::path& path() const { return pending_; }
  /// Makes a folder, with those above it; throws InputError where it cannot.
  void create(const std::filesystem::path& folder) const;
  /// Renames the folder to its final name.
  void commit();

 private:
  std::filesystem::path final_;
  std::filesystem::path pending_;
};

}  // namespace plumbline
