// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace plumbline {

/// Whether a file is read at once, or each part when it is looked at: one may be larger than
/// memory.
enum class FileUse { kWhole, kInParts };

/// A whole file in memory, read-only: mapped, so that text is parsed where it lies; a small one is
/// copied.
class MappedFile {
 public:
  /// Throws InputError where the file is missing, a folder or not readable.
  explicit MappedFile(const std::string& path, FileUse use = FileUse::kWhole);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view text() const { return text_; }

 private:
  std::unique_ptr<char[]> copy_;
  std::string_view text_;
};

/// All of standard input, once: what a pipe brings. Throws InputError where it cannot be read, or
/// brings more than 1 GB.
std::string readStandardInput();

/// XXH64 of the bytes as 16 hexadecimal digits: the same on every machine. Not for secrets.
std::string contentHash(std::string_view bytes);

/// Makes the missing folders of `name` within `folder`, which is there: a workplace (output.h) that
/// was removed meanwhile is not made again. Throws InputError where it cannot.
void makeFoldersIn(const std::filesystem::path& folder, const std::filesystem::path& name);

/// Writes FOLDER/NAME, which is not there yet, and the missing folders of `name`: for outputs that
/// get their names when they are complete. Throws InputError where it cannot.
void writeNewFile(const std::filesystem::path& folder, const std::filesystem::path& name,
                  std::string_view content);

/// Writes `content` (text or bytes) to `path`, whole or not at all: under a temporary name in the
/// same folder, then renamed over `path`. The folder must exist. Throws
/// InputError where it cannot be written; the temporary file is then removed and an older `path` is
/// as it was. Safe from several threads and processes: the last writer's content stays. For files
/// of a cache; results are outputs (output.h).
void writeFileAtomically(const std::string& path, std::string_view content);

/// Whether a file's name is one under which writeFileAtomically() writes `final_name`.
bool isTemporaryOf(std::string_view final_name, std::string_view name);

/// Removes the temporary files that writers died over in a folder; those being written stay.
void removeDeadTemporaries(const std::filesystem::path& folder);

}  // namespace plumbline
