// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/mapped_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"

namespace plumbline {
namespace {

struct Descriptor {
  int number = -1;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

InputError unreadable(const std::string& path) {
  return badInput(path, 0,
                  {"cannot be read (" + std::string(std::strerror(errno)) + ")", "a readable file",
                   "check the name and its permissions"});
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat status {};
  if (file.number < 0 || ::fstat(file.number, &status) != 0) throw unreadable(path);
  if (!S_ISREG(status.st_mode)) {
    throw badInput(path, 0, {"is not a regular file", "a file", "give the path of a file"});
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

}  // namespace plumbline
