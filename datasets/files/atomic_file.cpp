// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"

namespace plumbline {
namespace {

InputError unwritable(const std::string& path, int error) {
  return badInput(path, 0,
                  {"cannot be written (" + std::string(std::strerror(error)) + ")",
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

}  // namespace plumbline
