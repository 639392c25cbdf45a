// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/night_folder.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/workplace.h"
#include "evaluate/results/provenance.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockFile = "study.lock";
constexpr double kLockPauseS = 0.02;

BadInput unwritable(const fs::path& path, const std::string& why) {
  return badInput(path.string(), {InputFault::kUnwritable, "cannot be written (" + why + ")", "",
                                  "check its permissions, or give another folder"});
}

/// Results within a recording would change its hash, and a recording within results may be removed.
void refuseOverlap(const fs::path& folder, const fs::path& recording) {
  if (!isWithin(folder, recording) && !isWithin(recording, folder)) return;
  throw badInput(folder.string(), {InputFault::kInputInTheWay,
                                   "and the recording " + recording.string() + " overlap", "",
                                   "choose another folder"});
}

std::string studyIn(const fs::path& mark) {
  try {
    return nlohmann::json::parse(MappedFile(mark.string()).text()).at("study").get<std::string>();
  } catch (const nlohmann::json::exception& error) {
    throw badInput(mark.string(), {InputFault::kSyntax, error.what(), "a study's mark"});
  }
}

/// A folder that has no mark may be empty at most.
void refuseForeign(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) {
    throw badInput(folder.string(), {InputFault::kForeignFiles, "is not a folder", "a folder"});
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (isTemporaryOf(kStudyMarkFile, name)) continue;  // a first night that was killed at once
    throw badInput(folder.string(),
                   {InputFault::kForeignFiles, "holds " + name + " and is not a study's folder", "",
                    "choose another folder"});
  }
}

/// None of what is no folder, cannot be read, or vanishes meanwhile.
std::vector<fs::path> entriesOf(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    paths.push_back(it->path());
  }
  return paths;
}

}  // namespace

// By flock(), which the system releases however the process ends; the file stays, and what is in it
// only says who holds it.
NightLock::NightLock(const fs::path& folder, double wait_s) {
  const fs::path path = folder / kLockFile;
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw unwritable(folder, std::strerror(errno));
  int error = 0;
  for (int tries = static_cast<int>(wait_s / kLockPauseS); tries >= 0; --tries) {
    error = flock(file_, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    if (error != EWOULDBLOCK) break;
    std::this_thread::sleep_for(std::chrono::duration<double>(kLockPauseS));
  }
  if (error != 0) {
    char holder[512] = "";
    const ssize_t size = read(file_, holder, sizeof holder - 1);
    close(file_);
    if (error != EWOULDBLOCK) throw unwritable(path, std::strerror(error));
    throw badInput(folder.string(), {InputFault::kUnwritable,
                                     fmt::format("another night is running here{}",
                                                 size > 0 ? ": " + std::string(holder) : ""),
                                     "", "wait until it ends"});
  }
  const std::string text =
      fmt::format("process {} on {} since {}", getpid(), hostName(), makeProvenance("", {}).date);
  const bool written = ftruncate(file_, 0) == 0 &&
                       write(file_, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (!written) {
    close(file_);
    throw unwritable(path, std::strerror(errno));
  }
}

NightLock::~NightLock() { close(file_); }

void takeNightFolder(const fs::path& folder, const StudyDefinition& study) {
  const fs::path place = fs::weakly_canonical(fs::absolute(folder));
  for (const SessionEntry& s : study.sessions) refuseOverlap(place, s.path);
  for (const RecordingEntry& r : study.held_out) refuseOverlap(place, r.path);
  for (const RecordingEntry& r : study.sequences) refuseOverlap(place, r.path);
  const fs::path mark = folder / kStudyMarkFile;
  if (fs::exists(mark)) {
    // By the study's name: a definition that is edited, or lies elsewhere, is the same study.
    const std::string name = studyIn(mark);
    if (name == study.name) return;
    throw badInput(folder.string(), {InputFault::kForeignFiles,
                                     fmt::format("belongs to the study '{}', and this one is '{}'",
                                                 name, study.name),
                                     "", "choose another folder"});
  }
  refuseForeign(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw unwritable(folder, error.message());
  writeFileAtomically(
      mark.string(),
      nlohmann::ordered_json{{"program", "plumbline"}, {"kind", "study"}, {"study", study.name}}
              .dump() +
          "\n");
}

void removeLeftovers(const fs::path& folder) {
  removeDeadTemporaries(folder);
  // Steps, also those that are no longer planned, make their results beside their folders:
  // sessions/p1/.STEP.partial-XXXXXX.
  std::set<fs::path> places;
  for (const char* of_steps : {"sessions", "recordings"}) {
    for (const fs::path& owner : entriesOf(folder / of_steps)) {
      std::error_code error;
      if (fs::is_symlink(owner, error)) continue;
      for (const fs::path& path : entriesOf(owner)) {
        const std::string name = path.filename().string();
        const auto end = name.find(".partial-");
        if (name[0] != '.' || end == std::string::npos) continue;
        places.insert(fs::absolute(owner / name.substr(1, end - 1)));
      }
    }
  }
  for (const fs::path& place : places) removeDeadWorkplaces(place);
}

void requireNightFolder(const fs::path& folder) {
  if (fs::exists(folder / kStudyMarkFile) && fs::exists(folder / kHistoryFile)) return;
  throw badInput(folder.string(), {InputFault::kMissingFile, "contains no results of a study",
                                   "the folder that plumbline study --out wrote"});
}

}  // namespace plumbline
