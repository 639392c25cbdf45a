// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/file_io.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "calibrator/base/error.h"
#include "datasets/files/bad_input.h"

namespace plumbline {
namespace {

struct Descriptor {
  int number = -1;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

BadInput unreadable(const std::string& path) {
  return badInput(
      path, {InputFault::kMissingFile, "cannot be read (" + std::string(std::strerror(errno)) + ")",
             "a readable file", "check the name and its permissions"});
}

BadInput unwritable(const std::string& path, int error) {
  return badInput(
      path,
      {InputFault::kUnwritable, "cannot be written (" + std::string(std::strerror(error)) + ")",
       "a writable folder with free space", "check the folder, its permissions and the disk"});
}

// A temporary file's name: its final one, this, and six letters that mkostemp() makes of these.
constexpr std::string_view kTemporary = ".partial-", kMade = "XXXXXX";

// 0, or the errno of what failed.
int writeAll(int file, std::string_view content) {
  int error = 0;
  while (!content.empty() && error == 0) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written >= 0) {
      content.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  return error;
}

BadInput irregular(const std::string& path) {
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(path, unknown);
  return badInput(path, {InputFault::kMissingFile, folder ? "is a folder" : "is not a regular file",
                         "a file", "give the path of a file"});
}

constexpr std::size_t kSmall = 1U << 16U;  // mapping and unmapping takes longer than copying

/// Reads up to `size` bytes; how many there were, or nothing where the file cannot be read.
std::optional<std::size_t> readAll(int file, char* to, std::size_t size) {
  std::size_t at = 0;
  while (at < size) {
    const ssize_t read = ::read(file, to + at, size - at);
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) return std::nullopt;
    if (read == 0) break;  // cut off meanwhile
    at += static_cast<std::size_t>(read);
  }
  return at;
}

}  // namespace

MappedFile::MappedFile(const std::string& path, FileUse use) {
  // A pipe or a device is not even opened, which could wait for ever or move a tape; and a pipe
  // that takes the file's place meanwhile is not waited for.
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw unreadable(path);
  if (!S_ISREG(status.st_mode)) throw irregular(path);
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  if (file.number < 0 || ::fstat(file.number, &status) != 0) throw unreadable(path);
  if (!S_ISREG(status.st_mode)) throw irregular(path);
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size <= kSmall) {
    // Exactly as long as the file: reading beyond its end is then seen by AddressSanitizer.
    copy_ = std::make_unique_for_overwrite<char[]>(size);
    const auto length = readAll(file.number, copy_.get(), size);
    if (!length) throw unreadable(path);
    text_ = {copy_.get(), *length};
    return;
  }
  const int flags = MAP_PRIVATE | (use == FileUse::kWhole ? MAP_POPULATE : 0);
  void* memory = ::mmap(nullptr, size, PROT_READ, flags, file.number, 0);
  if (memory == MAP_FAILED) throw unreadable(path);
  text_ = {static_cast<const char*>(memory), size};
}

MappedFile::~MappedFile() {
  if (text_.size() > kSmall) ::munmap(const_cast<char*>(text_.data()), text_.size());
}

std::string readStandardInput() {
  // A pipe may deliver without end.
  constexpr std::size_t kMostBytes = 1U << 30U;
  constexpr std::size_t kBlock = 1U << 20U;
  const std::string name = "standard input";
  std::string text;
  for (std::size_t size = 0;;) {
    text.resize(size + kBlock);
    const ssize_t read = ::read(STDIN_FILENO, text.data() + size, kBlock);
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) throw unreadable(name);
    size += static_cast<std::size_t>(read);
    text.resize(size);
    if (read == 0) return text;
    if (size > kMostBytes) {
      throw badInput(name, {InputFault::kOutOfRange, "delivers more than 1 GB", "less",
                            "write it into a file"});
    }
  }
}

std::string contentHash(std::string_view bytes) {
  return fmt::format("{:016x}", XXH64(bytes.data(), bytes.size(), 0));
}

void makeFoldersIn(const std::filesystem::path& folder, const std::filesystem::path& name) {
  std::filesystem::path path = folder;
  for (const std::filesystem::path& part : name) {
    path /= part;
    if (::mkdir(path.c_str(), 0777) != 0 && errno != EEXIST) throw unwritable(path.string(), errno);
  }
}

void writeNewFile(const std::filesystem::path& folder, const std::filesystem::path& name,
                  std::string_view content) {
  makeFoldersIn(folder, name.parent_path());
  const std::string path = (folder / name).string();
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) throw unwritable(path, errno);
  int error = writeAll(file, content);
  if (::close(file) != 0 && error == 0) error = errno;
  if (error != 0) throw unwritable(path, error);
}

void writeFileAtomically(const std::string& path, std::string_view content) {
  std::string temporary = path + std::string(kTemporary) + std::string(kMade);
  // Held by a lock as long as it is written, so that it can be told from a dead writer's.
  const Descriptor file{::mkostemp(temporary.data(), O_CLOEXEC)};
  if (file.number < 0) throw unwritable(path, errno);
  (void)::flock(file.number, LOCK_EX | LOCK_NB);
  int error = writeAll(file.number, content);
  // mkostemp() makes files that only their owner may read.
  if (error == 0 && ::fchmod(file.number, 0644) != 0) error = errno;
  // No fsync: a killed process leaves the older file or the newer one; after a power failure the
  // newer one may be empty.
  if (error == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return;
  ::unlink(temporary.c_str());
  throw unwritable(path, error);
}

bool isTemporaryOf(std::string_view final_name, std::string_view name) {
  return name.size() == final_name.size() + kTemporary.size() + kMade.size() &&
         name.starts_with(final_name) && name.substr(final_name.size()).starts_with(kTemporary);
}

void removeDeadTemporaries(const std::filesystem::path& folder) {
  std::error_code fault;
  for (std::filesystem::directory_iterator it(folder, fault), end; !fault && it != end;
       it.increment(fault)) {
    const std::string name = it->path().filename().string();
    if (!isTemporaryOf(std::string_view(name).substr(0, name.rfind(kTemporary)), name)) continue;
    // For writing, as an exclusive lock on a network file system needs it.
    const Descriptor file{::open(it->path().c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    struct stat status {};
    const bool ours = file.number >= 0 && ::fstat(file.number, &status) == 0 &&
                      S_ISREG(status.st_mode) && status.st_uid == ::geteuid();
    if (ours && ::flock(file.number, LOCK_EX | LOCK_NB) == 0) ::unlink(it->path().c_str());
  }
}

}  // namespace plumbline
