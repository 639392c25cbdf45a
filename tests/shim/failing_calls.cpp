// SPDX-License-Identifier: BSD-3-Clause
// Preloaded into the program by tests: counts its calls that change files, and ends it, or fills
// its disk, at one of them.
//   PLUMBLINE_KILL_AT=N   SIGKILL before the N-th call that changes a file or a name
//   PLUMBLINE_FULL_AT=N   from the N-th call that writes bytes on, there is no space (ENOSPC)
//   PLUMBLINE_NO_EXCHANGE=1  a file system that cannot exchange names
//   PLUMBLINE_LINK_ERROR=N  a file system without hard links: link() fails with this errno
//   PLUMBLINE_PID=N       the process takes itself for this one, as two in containers may
//   PLUMBLINE_COUNTS=FILE the numbers of both, written when the program ends
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

std::atomic<long> changes{0};
std::atomic<long> writes{0};

long numberIn(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? -1 : std::atol(text);
}

void change() {
  static const long kill_at = numberIn("PLUMBLINE_KILL_AT");
  if (++changes == kill_at) raise(SIGKILL);
}

bool isFull(int file) {
  static const long full_at = numberIn("PLUMBLINE_FULL_AT");
  if (file <= STDERR_FILENO) return false;
  change();
  const long number = ++writes;
  if (full_at < 0 || number < full_at) return false;
  errno = ENOSPC;
  return true;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

struct Counts {
  ~Counts() {
    const char* path = std::getenv("PLUMBLINE_COUNTS");
    if (path == nullptr) return;
    std::FILE* file = std::fopen(path, "w");
    std::fprintf(file, "%ld %ld\n", changes.load(), writes.load());
    std::fclose(file);
  }
} counts;

}  // namespace

extern "C" pid_t getpid() {
  static const long stated = numberIn("PLUMBLINE_PID");
  static auto* const real = next<pid_t()>("getpid");
  return stated < 0 ? real() : static_cast<pid_t>(stated);
}

// Every one of the C library's under its own name.
#define PLUMBLINE_CHANGE(name, declared, given)          \
  extern "C" int name declared {                         \
    change();                                            \
    static auto* const real = next<int declared>(#name); \
    return real given;                                   \
  }
PLUMBLINE_CHANGE(rename, (const char* from, const char* to), (from, to))
extern "C" int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  static const bool refused = std::getenv("PLUMBLINE_NO_EXCHANGE") != nullptr;
  if (refused) {
    errno = EINVAL;
    return -1;
  }
  change();
  static auto* const real = next<int(int, const char*, int, const char*, unsigned)>("renameat2");
  return real(a, from, b, to, flags);
}
extern "C" int link(const char* from, const char* to) {
  static const long error = numberIn("PLUMBLINE_LINK_ERROR");
  change();
  if (error >= 0) {
    errno = static_cast<int>(error);
    return -1;
  }
  static auto* const real = next<int(const char*, const char*)>("link");
  return real(from, to);
}
PLUMBLINE_CHANGE(unlink, (const char* path), (path))
PLUMBLINE_CHANGE(unlinkat, (int folder, const char* path, int flags), (folder, path, flags))
PLUMBLINE_CHANGE(rmdir, (const char* path), (path))
PLUMBLINE_CHANGE(remove, (const char* path), (path))
PLUMBLINE_CHANGE(mkdir, (const char* path, mode_t mode), (path, mode))

#define PLUMBLINE_WRITE(name, declared, given)               \
  extern "C" ssize_t name declared {                         \
    if (isFull(file)) return -1;                             \
    static auto* const real = next<ssize_t declared>(#name); \
    return real given;                                       \
  }
PLUMBLINE_WRITE(write, (int file, const void* bytes, size_t size), (file, bytes, size))
PLUMBLINE_WRITE(pwrite, (int file, const void* bytes, size_t size, off_t at),
                (file, bytes, size, at))
PLUMBLINE_WRITE(pwrite64, (int file, const void* bytes, size_t size, off64_t at),
                (file, bytes, size, at))
PLUMBLINE_WRITE(writev, (int file, const iovec* parts, int count), (file, parts, count))
