// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/results/result_folder.h"

#include <system_error>

#include <unistd.h>

#include "calibrator/base/error.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// The uppermost folder of `path` that does not exist; empty where all of it does.
fs::path firstMissing(const fs::path& path) {
  fs::path missing;
  std::error_code error;
  for (fs::path p = path; !p.empty() && !fs::exists(p, error); p = p.parent_path()) missing = p;
  return missing;
}

fs::path parentOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void refuseFoldersInTheWay(const fs::path& out, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (!fs::is_directory(out / name)) continue;
    throw InputError((out / name).string(), 0,
                     "is a folder where a result belongs; remove it or give another --out");
  }
}

void moveFiles(const fs::path& from, const fs::path& out, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (fs::exists(from / name)) {
      fs::rename(from / name, out / name);
    } else {
      fs::remove(out / name);
    }
  }
}

}  // namespace

void refuseUnwritable(const std::string& out) {
  if (out.empty()) throw InputError("--out is empty: expected the folder for the results");
  const fs::path missing = firstMissing(out);
  const fs::path there = missing.empty() ? fs::path(out) : parentOf(missing);
  std::error_code error;
  if (!fs::is_directory(there, error)) {
    throw InputError(there.string(), 0,
                     "is in the way: expected a folder for the results; give another --out");
  }
  if (::access(there.c_str(), W_OK | X_OK) != 0) {
    throw InputError(there.string(), 0,
                     "is not writable: expected a folder for the results; give another --out");
  }
}

void writeResultFiles(const std::string& out, const std::vector<ResultFile>& files,
                      const std::function<void(const fs::path& records)>& save) {
  refuseUnwritable(out);
  const fs::path missing = firstMissing(out);
  std::vector<std::string> names;
  if (save) names.emplace_back(kRecordsFile);
  for (const ResultFile& file : files) names.push_back(file.name);
  try {
    fs::create_directories(out);
    refuseFoldersInTheWay(out, names);
    const PendingFolder pending(fs::path(out) / ".results");  // never committed: its files move
    for (const ResultFile& file : files) {
      if (file.text) writeFileAtomically((pending.path() / file.name).string(), *file.text);
    }
    if (save) save(pending.path() / kRecordsFile);
    moveFiles(pending.path(), out, names);
  } catch (...) {
    std::error_code ignored;
    if (!missing.empty()) fs::remove_all(missing, ignored);
    throw;
  }
}

}  // namespace plumbline
