// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/session/write_session.h"

#include <filesystem>
#include <vector>

#include "calibrator/base/statistics.h"
#include "datasets/files/file_io.h"
#include "datasets/session/session_writer.h"

namespace plumbline {
namespace {

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
  PendingFolder pending{std::filesystem::path(folder)};
  for (const TextFile& file : sessionFiles(session, frameRate(session), ViewFormat::kCorners)) {
    const auto path = pending.path() / file.path;
    pending.create(path.parent_path());
    writeFileAtomically(path.string(), file.text);
  }
  pending.commit();
}

}  // namespace plumbline
