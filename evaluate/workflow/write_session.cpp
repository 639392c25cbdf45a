// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/workflow/write_session.h"

#include <filesystem>
#include <system_error>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/statistics.h"
#include "datasets/atomic_file.h"
#include "datasets/session_writer.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// Frames a second of camera 0; 0 where it has fewer than two.
double frameRate(const Session& session) {
  if (session.cameras.empty()) return 0;
  const auto& views = session.cameras.front().views;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < views.size(); ++i) {
    intervals.push_back(secondsBetween(views[i - 1].t, views[i].t));
  }
  return intervals.empty() ? 0 : 1 / quantile(intervals, 0.5);
}

}  // namespace

void writeCornerSession(const Session& session, const std::string& folder) {
  const fs::path target(folder);
  if (fs::exists(target) && !(fs::is_directory(target) && fs::is_empty(target))) {
    throw InputError(folder, 0, "exists and is not an empty folder; choose another --out");
  }
  const fs::path work = folder + ".tmp";
  fs::remove_all(work);
  try {
    for (const TextFile& file : sessionFiles(session, frameRate(session), ViewFormat::kCorners)) {
      fs::create_directories((work / file.path).parent_path());
      writeFileAtomically((work / file.path).string(), file.text);
    }
    fs::remove(target);
    fs::rename(work, target);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(work, ignored);
    throw;
  }
}

}  // namespace plumbline
