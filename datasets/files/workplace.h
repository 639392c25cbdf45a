// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace plumbline {

/// The machine's name, for locks; "unknown" where the system does not say.
std::string hostName();

/// "2026-11-25T07:00:00Z" of seconds since 1970.
std::string utcText(std::time_t seconds);

/// Whether `path` is `folder` or lies in it, by their names alone: links are not followed, and both
/// are absolute or both relative to the same folder.
bool isWithin(const std::filesystem::path& path, const std::filesystem::path& folder);

/// Absolute, with links resolved as far as they can be: what cannot be reached, such as another
/// user's cache, is left to who reads it.
std::filesystem::path resolvedAsFar(const std::filesystem::path& path);

/// Where an output is made before it takes its final name: a hidden folder beside it,
///   PARENT/.NAME.partial-XXXXXX/lock     held (flock) as long as the process lives, or a program
///                                        that it ran: its id, host and start, and NAME
///   PARENT/.NAME.partial-XXXXXX/result   the output, a folder or a file
///   PARENT/.NAME.partial-XXXXXX/old      what it replaces, on file systems that cannot exchange
/// XXXXXX is random (mkdtemp), so that equal process ids of containers do not meet. Workplaces of
/// NAME whose lock is not held are of processes that died: see removeDeadWorkplaces().
class Workplace {
 public:
  /// Makes the missing folders above `final_path` (absolute) and the workplace. Throws InputError,
  /// naming `shown`, where they cannot be made.
  Workplace(const std::filesystem::path& final_path, const std::string& shown);
  /// Removes the workplace, and the folders above that were made for it and are empty.
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  std::filesystem::path result() const { return folder_ / "result"; }

  /// What a name change met.
  enum class Moved { kDone, kInTheWay, kFailed };
  /// Gives the result its final name at once; replaces nothing but an empty folder. kFailed: errno
  /// says why.
  Moved place();
  /// Gives a file its final name and replaces the file that had it; false: errno says why.
  bool replaceFile();
  /// Exchanges the result with the folder that has its name, which then is result(); twice: as
  /// before. False: errno says why.
  bool exchange();
  /// The output has its name: the folders above it stay. What was replaced, if a folder, must be
  /// removed from result() before the workplace goes.
  void done();

 private:
  void makeFolders();
  void makeLocked(const std::string& shown);

  std::filesystem::path final_;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  // folders above, from the top
  int lock_ = -1;
  friend void abandonWorkplaces();
  void remove() noexcept;
  void abandon() const noexcept;
};

/// Removes the workplaces of `final_path` (absolute) that dead processes of this user left, and
/// puts back the result that one of them had moved aside. Those of live processes, and whatever
/// only has a like name, stay.
void removeDeadWorkplaces(const std::filesystem::path& final_path);

/// A message with the final names in place of the paths into workplaces: the latter are gone by the
/// time that anybody reads it.
std::string withFinalNames(std::string message);

/// Removes what every Workplace of this process has made and lets none be finished any more: calls
/// that would change something wait for ever. For the thread that ends the process on a signal;
/// outputs that have their names stay.
void abandonWorkplaces();

}  // namespace plumbline
