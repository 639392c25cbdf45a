// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace plumbline {

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
