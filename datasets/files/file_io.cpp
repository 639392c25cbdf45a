// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/file_io.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
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
      path, 0,
      {InputFault::kMissingFile, "cannot be read (" + std::string(std::strerror(errno)) + ")",
       "a readable file", "check the name and its permissions"});
}

BadInput unwritable(const std::string& path, int error) {
  return badInput(
      path, 0,
      {InputFault::kUnwritable, "cannot be written (" + std::string(std::strerror(error)) + ")",
       "a writable folder with free space",
       "check the folder, its permissions and the "
       "disk"});
}

std::string temporaryName(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return path + ".partial-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
}

// 0, or the errno of what failed. Closes the file in any case.
int writeAndClose(int file, std::string_view content) {
  int error = 0;
  while (!content.empty() && error == 0) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written >= 0) {
      content.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (::close(file) != 0 && error == 0) error = errno;
  return error;
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat status {};
  if (file.number < 0 || ::fstat(file.number, &status) != 0) throw unreadable(path);
  if (!S_ISREG(status.st_mode)) {
    throw badInput(
        path, 0,
        {InputFault::kMissingFile, "is not a regular file", "a file", "give the path of a file"});
  }
  size_ = static_cast<std::size_t>(status.st_size);
  if (size_ == 0) return;  // nothing to map; text() is empty
  void* memory = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file.number, 0);
  if (memory == MAP_FAILED) throw unreadable(path);
  data_ = static_cast<const char*>(memory);
}

MappedFile::~MappedFile() {
  if (size_ > 0) ::munmap(const_cast<char*>(data_), size_);
}

std::string contentHash(std::string_view bytes) {
  return fmt::format("{:016x}", XXH64(bytes.data(), bytes.size(), 0));
}

void writeFileAtomically(const std::string& path, std::string_view content) {
  const std::string temporary = temporaryName(path);
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) throw unwritable(path, errno);
  int error = writeAndClose(file, content);
  if (error == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return;
  ::unlink(temporary.c_str());
  throw unwritable(path, error);
}

namespace fs = std::filesystem;

PendingFolder::PendingFolder(const fs::path& final_path) : final_(final_path.lexically_normal()) {
  if (!final_.has_filename()) final_ = final_.parent_path();
  std::error_code fault;
  const bool exists = fs::exists(final_, fault);
  if (exists && !(fs::is_directory(final_, fault) && fs::is_empty(final_, fault))) {
    throw BadInput(InputFault::kUnwritable, final_.string(), 0,
                   "exists already; expected a new or empty folder; choose another or remove it");
  }
  const fs::path parent = fs::absolute(final_).parent_path();
  pending_ = parent / fmt::format(".{}.partial-{}", final_.filename().string(), getpid());
  create(pending_);
}

PendingFolder::~PendingFolder() {
  std::error_code ignored;
  if (!pending_.empty()) fs::remove_all(pending_, ignored);
}

void PendingFolder::create(const fs::path& folder) const {
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault)
    throw BadInput(InputFault::kUnwritable, final_.string(), 0,
                   "cannot be created: " + fault.message());
}

void PendingFolder::commit() {
  std::error_code fault;
  fs::rename(pending_, final_, fault);
  if (fault)
    throw BadInput(InputFault::kUnwritable, final_.string(), 0,
                   "cannot be written: " + fault.message());
  pending_.clear();
}

}  // namespace plumbline
