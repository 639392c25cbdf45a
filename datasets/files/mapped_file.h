// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
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

}  // namespace plumbline
