// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/replay_inputs.h"

#include <numeric>
#include <set>

#include "evaluate/replay/guide_frames.h"

namespace plumbline {

std::vector<int> ReplayRun::accepted(GuideStage stage) const {
  std::set<int> positions;
  for (const Decision& d : decisions) {
    if (d.stage == stage && d.accepted) positions.insert(d.frame);
    for (const int frame : d.withdrawn) positions.erase(frame);
  }
  return {positions.begin(), positions.end()};
}

const Decision* ReplayRun::finish(GuideStage stage) const {
  for (const Decision& d : decisions) {
    if (d.stage == stage && d.mode == GuideMode::kFinished && d.reason != GuideReason::kFinished) {
      return &d;
    }
  }
  return nullptr;
}

Session ReplayRun::sessionOfFrames(const std::vector<int>& wanted) const {
  return sessionOf(session, frames, wanted);
}

Session ReplayRun::sessionFrom(int first) const {
  std::vector<int> wanted(frames.size() - static_cast<std::size_t>(first));
  std::iota(wanted.begin(), wanted.end(), first);
  return sessionOfFrames(wanted);
}

}  // namespace plumbline
