// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace plumbline {

/// Which state of a file or folder this is, without reading it: XXH64 over path below the folder,
/// size, both times of change and inode of every file in it, links followed, hidden ones left out.
/// Any write changes it, unless the clock was set back. Throws InputError where `path` is not there
/// or a folder in it cannot be listed.
std::string stampOf(const std::filesystem::path& path);

/// XXH64 over the contents of files and folders, whatever their place: of a folder over the paths
/// below it and the contents of its files, hidden ones left out. What was hashed before and has the
/// same stampOf() is not read again.
class InputHashes {
 public:
  /// Reads what was hashed before, where `cache` is there and whole.
  explicit InputHashes(std::filesystem::path cache);

  struct Hashed {
    std::string content;  ///< 16 hexadecimal digits
    std::string stamp;
  };
  /// Throws InputError where `path` cannot be read.
  Hashed of(const std::filesystem::path& path);

  /// Writes the cache, whole or not at all; InputError where it cannot.
  void save() const;

 private:
  std::filesystem::path cache_;
  std::map<std::string, Hashed> known_;  // by path
  std::map<std::string, Hashed> seen_;   // asked for by this process
};

}  // namespace plumbline
