// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/workplace.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/manifest.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = "plumbline\n";
constexpr const char* kLock = "lock";
constexpr const char* kOld = "old";
constexpr std::size_t kLongestName = 200;  // of NAME, so that the whole fits into NAME_MAX
constexpr std::size_t kRandom = 6;         // characters, of mkdtemp
constexpr int kTries = 100;

// Recursive: what holds it for a change removes workplaces too.
struct Register {
  std::recursive_mutex mutex;
  std::set<Workplace*> workplaces;
};

Register& unfinished() {
  static Register all;
  return all;
}

/// Hidden, and beside the final name: a rename within one folder is atomic.
std::string prefixOf(const fs::path& final_path) {
  return "." + final_path.filename().string().substr(0, kLongestName) + ".partial-";
}

// NAME as the last line, so that it may hold anything but a line end.
std::string lockText(const fs::path& final_path) {
  return fmt::format("{}pid {}\nhost {}\nstarted {}\nfor {}\n", kMark, ::getpid(), hostName(),
                     utcText(std::time(nullptr)), final_path.filename().string());
}

BadInput unmakeable(const std::string& path, int error) {
  return badInput(
      path, {InputFault::kUnwritable, fmt::format("cannot be written ({})", std::strerror(error)),
             "a path in a writable folder with free space",
             "check the folder, its permissions and the disk, or choose another output"});
}

// Removes a result, whole or half made, that has not got its name. A whole one is removed as its
// manifest says: after an exchange it is the older result, which was its user's to add to.
void removeResult(const fs::path& result) {
  std::error_code ignored;
  const auto manifest = readManifest(result);
  if (manifest) return removeListed(result, *manifest);
  fs::remove_all(result, ignored);
}

std::vector<fs::path> besideLock(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename() != kLock) paths.push_back(it->path());
  }
  return paths;
}

// `lock` is open and held by the caller, or the folder is the caller's own.
void removeWorkplace(const fs::path& folder) {
  std::error_code ignored;
  removeResult(folder / "result");
  removeResult(folder / kOld);
  if (fs::exists(folder / "result", ignored) || fs::exists(folder / kOld, ignored)) return;
  // What was made on the way, such as a log or a workplace of a program that was run. The lock goes
  // last: a process that is killed before leaves a workplace that the next one knows for stale.
  for (const fs::path& path : besideLock(folder)) fs::remove_all(path, ignored);
  if (!besideLock(folder).empty()) return;
  ::unlink((folder / kLock).c_str());
  ::rmdir(folder.c_str());
}

// Where the result of a lock's process was to go; empty where the lock does not say.
fs::path homeOf(const fs::path& folder, std::string_view lock_text) {
  const std::size_t at = lock_text.rfind("\nfor ");
  if (at == std::string_view::npos) return {};
  std::string name(lock_text.substr(at + 5));
  if (!name.empty() && name.back() == '\n') name.pop_back();
  // A name and never a path: what the lock says must not lead out of this folder.
  if (name.empty() || name.find('/') != std::string::npos) return {};
  return folder.parent_path() / name;
}

// Puts back the result that was moved aside by a process that died before the new one had its name.
// False where that is needed and cannot be done.
bool putBack(const fs::path& folder, const fs::path& home) {
  std::error_code error;
  if (!fs::exists(folder / kOld, error)) return true;
  if (home.empty()) return false;
  if (fs::exists(fs::symlink_status(home, error))) return true;
  fs::rename(folder / kOld, home, error);
  return !error;
}

// After an exchange: what others had put into the older result belongs into the new one.
void moveOthers(const fs::path& folder, const fs::path& home) {
  if (home.empty()) return;
  const auto of_home = readManifest(home);
  for (const fs::path& older : {folder / "result", folder / kOld}) {
    const auto manifest = readManifest(older);
    // One of another kind is of a command that was killed while it made this result.
    if (of_home && manifest && manifest->kind == of_home->kind) {
      moveUnlisted(older, *manifest, home);
    }
  }
}

bool isOfThisUser(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 && status.st_uid == ::geteuid();
}

/// A lock that nobody holds is a dead process's. Workplaces of other users are left alone.
void removeIfStale(const fs::path& folder) {
  const fs::path path = folder / kLock;
  // For writing: on NFS an exclusive lock is one of bytes, which a file that is only read cannot
  // have.
  const int lock = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (lock < 0) {
    if (errno == ENOENT) ::rmdir(folder.c_str());  // killed before it had a lock; only if empty
    return;
  }
  if (isOfThisUser(lock) && ::flock(lock, LOCK_EX | LOCK_NB) == 0) {
    std::string text(4096, '\0');
    const ssize_t size = ::read(lock, text.data(), text.size());
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    if (text.substr(0, kMark.size()) == kMark) {
      const fs::path home = homeOf(folder, text);
      if (putBack(folder, home)) {
        moveOthers(folder, home);
        removeWorkplace(folder);
      }
    } else if (text.empty()) {  // killed before it wrote into the lock: nothing else is there
      ::unlink(path.c_str());
      ::rmdir(folder.c_str());
    }
  }
  ::close(lock);
  ::rmdir(folder.c_str());  // NFS keeps a removed file in it until that is closed
}

// Open, held and still where it was made: a workplace that another process took for stale in the
// moment before is not. -1: it must be made anew.
int takeLock(const fs::path& folder, const std::string& text) {
  const fs::path path = folder / kLock;
  // Without O_CLOEXEC: a program that this process runs may write into the workplace and die later
  // than this process. It holds the lock until then.
  const int lock = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL, 0644);
  if (lock < 0) return -1;
  struct stat status {};
  // On a file system without locks the work goes on unlocked; nobody takes it for stale, which
  // needs the lock.
  const bool held = ::flock(lock, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
  if (!held || ::fstat(lock, &status) != 0 || status.st_nlink == 0) {
    ::close(lock);
    errno = ENOENT;
    return -1;
  }
  if (::write(lock, text.data(), text.size()) == static_cast<ssize_t>(text.size())) return lock;
  const int error = errno;
  ::unlink(path.c_str());
  ::close(lock);
  errno = error;
  return -1;
}

// Of link(): FAT, some FUSE, AFS between folders, more names than a file may have. Where rename()
// fails as well, it says why.
bool cannotLink(int error) {
  return error == EPERM || error == EOPNOTSUPP || error == ENOSYS || error == EXDEV ||
         error == EMLINK;
}

}  // namespace

std::string hostName() {
  char name[256] = "";
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string utcText(std::time_t seconds) {
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

bool isWithin(const fs::path& path, const fs::path& folder) {
  return std::ranges::mismatch(folder, path).in1 == folder.end();
}

fs::path resolvedAsFar(const fs::path& path) {
  const fs::path named = fs::absolute(path);
  std::error_code error;
  fs::path resolved = fs::weakly_canonical(named, error);
  return error ? named.lexically_normal() : resolved;
}

void removeDeadWorkplaces(const fs::path& final_path) {
  const std::string prefix = prefixOf(final_path);
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(final_path.parent_path(), error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.size() == prefix.size() + kRandom && name.compare(0, prefix.size(), prefix) == 0) {
      found.push_back(it->path());
    }
  }
  for (const fs::path& folder : found) removeIfStale(folder);
}

std::string withFinalNames(std::string message) {
  constexpr std::string_view kMiddle = ".partial-", kEnd = "/result";
  for (std::size_t at = message.find(kMiddle); at != std::string::npos;
       at = message.find(kMiddle, at + 1)) {
    const std::size_t end = at + kMiddle.size() + kRandom;
    const std::size_t slash = message.rfind('/', at);
    const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
    if (end > message.size() || message.compare(end, kEnd.size(), kEnd) != 0 ||
        message[name] != '.')
      continue;
    message.erase(at, end + kEnd.size() - at);
    message.erase(name, 1);
  }
  return message;
}

Workplace::Workplace(const fs::path& final_path, const std::string& shown) : final_(final_path) {
  const std::lock_guard guard(unfinished().mutex);
  try {
    makeLocked(shown);
  } catch (...) {
    remove();
    throw;
  }
  unfinished().workplaces.insert(this);
}

Workplace::~Workplace() {
  const std::lock_guard guard(unfinished().mutex);
  unfinished().workplaces.erase(this);
  remove();
}

void Workplace::makeFolders() {
  fs::path at;
  for (const fs::path& part : final_.parent_path()) {
    at /= part;
    if (::mkdir(at.c_str(), 0777) == 0)
      made_.push_back(at);  // otherwise it is there, or mkdtemp tells
  }
}

// A sibling that fails removes the folders that it made, if they are empty: they are made again.
void Workplace::makeLocked(const std::string& shown) {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    makeFolders();
    std::string name = (final_.parent_path() / (prefixOf(final_) + "XXXXXX")).string();
    if (::mkdtemp(name.data()) == nullptr) {
      if (errno == ENOENT) continue;
      throw unmakeable(shown, errno);
    }
    folder_ = name;
    lock_ = takeLock(folder_, lockText(final_));
    if (lock_ >= 0) return;
    const int error = errno;
    ::rmdir(folder_.c_str());
    folder_.clear();
    if (error != ENOENT && error != EEXIST) throw unmakeable(shown, error);
  }
  throw unmakeable(shown, EBUSY);
}

Workplace::Moved Workplace::place() {
  const std::lock_guard guard(unfinished().mutex);
  const fs::path from = result();
  // rename() of a folder replaces an empty folder at most, of a file any file; link() nothing.
  const bool folder = fs::is_directory(fs::symlink_status(from));
  const int failed =
      folder ? std::rename(from.c_str(), final_.c_str()) : ::link(from.c_str(), final_.c_str());
  if (failed == 0) return Moved::kDone;
  if (!folder && cannotLink(errno)) {
    if (fs::exists(fs::symlink_status(final_))) return Moved::kInTheWay;
    return std::rename(from.c_str(), final_.c_str()) == 0 ? Moved::kDone : Moved::kFailed;
  }
  return errno == EEXIST || errno == ENOTEMPTY || errno == ENOTDIR ? Moved::kInTheWay
                                                                   : Moved::kFailed;
}

bool Workplace::replaceFile() {
  const std::lock_guard guard(unfinished().mutex);
  return std::rename(result().c_str(), final_.c_str()) == 0;
}

bool Workplace::exchange() {
  const std::lock_guard guard(unfinished().mutex);
  const fs::path from = result();
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, final_.c_str(), RENAME_EXCHANGE) == 0) {
    return true;
  }
  if (errno != EINVAL && errno != ENOSYS) return false;
  // Not at once: killed in between, the next run puts the older result back (see putBack()).
  const fs::path old = folder_ / kOld;
  if (std::rename(final_.c_str(), old.c_str()) != 0) return false;
  if (std::rename(from.c_str(), final_.c_str()) != 0) {
    const int error = errno;
    (void)std::rename(old.c_str(), final_.c_str());
    errno = error;
    return false;
  }
  return std::rename(old.c_str(), from.c_str()) == 0;
}

void Workplace::done() {
  const std::lock_guard guard(unfinished().mutex);
  made_.clear();
}

void Workplace::remove() noexcept {
  if (!folder_.empty()) removeWorkplace(folder_);
  if (lock_ >= 0) ::close(lock_);
  lock_ = -1;
  if (!folder_.empty()) ::rmdir(folder_.c_str());  // see removeIfStale()
  folder_.clear();
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) ::rmdir(folder->c_str());
  made_.clear();
}

// Other threads may still be writing into it: until the folder is gone, they can add files. Its
// name stays, or what they write next would go to the working directory.
void Workplace::abandon() const noexcept {
  std::error_code ignored;
  for (int attempt = 0; attempt < kTries && fs::exists(folder_, ignored); ++attempt) {
    removeWorkplace(folder_);
  }
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) ::rmdir(folder->c_str());
}

void abandonWorkplaces() {
  unfinished().mutex.lock();  // and never unlocked: see the header
  for (const Workplace* workplace : unfinished().workplaces) workplace->abandon();
}

}  // namespace plumbline
