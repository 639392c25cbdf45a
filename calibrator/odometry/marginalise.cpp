// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <utility>

#include "calibrator/linear/dense.h"
#include "calibrator/odometry/window_problem.h"

namespace plumbline {
namespace {

/// The part of the window that leaves: all its frames (so that indices stay), the links beside
/// `leaving`, the landmarks that go, the prior. A link belongs to the frame before it, hence
/// leaving - 1.
Window leavingPart(const Window& window, int leaving, const std::set<std::int64_t>& landmarks) {
  Window part;
  part.frames = window.frames;
  part.prior = window.prior;
  for (int i = 0; i < static_cast<int>(part.frames.size()); ++i) {
    OdometryFrame& frame = part.frames[i];
    // All other terms stay in the window: in the prior as well they would count twice.
    if (i != leaving && i != leaving - 1) frame.link.reset();
    if (i != leaving) frame.still = false;
  }
  for (const std::int64_t id : landmarks) {
    const auto landmark = window.landmarks.find(id);
    if (landmark != window.landmarks.end()) part.landmarks.insert(*landmark);
  }
  return part;
}

/// Which frames have terms in `part`.
std::vector<int> framesOf(const Window& part, int leaving) {
  std::set<int> frames{leaving};
  for (const std::int64_t serial : part.prior.frames) frames.insert(part.indexOf(serial));
  for (std::size_t i = 0; i + 1 < part.frames.size(); ++i) {
    if (!part.frames[i].link) continue;
    frames.insert(static_cast<int>(i));
    frames.insert(static_cast<int>(i) + 1);
  }
  for (const auto& [id, landmark] : part.landmarks) {
    if (!isUsed(landmark)) continue;
    for (const LandmarkSighting& s : landmark.sightings) frames.insert(part.indexOf(s.frame));
  }
  return {frames.begin(), frames.end()};
}

/// Takes the frame out with all its sightings. The link that led to it leads nowhere now.
void dropFrame(Window& window, int leaving) {
  const std::int64_t serial = window.frames[leaving].serial;
  window.frames.erase(window.frames.begin() + leaving);
  if (leaving > 0) window.frames[static_cast<std::size_t>(leaving) - 1].link.reset();
  for (auto& [id, landmark] : window.landmarks) {
    std::erase_if(landmark.sightings, [&](const LandmarkSighting& s) { return s.frame == serial; });
  }
  std::erase_if(window.landmarks, [](const auto& l) { return l.second.sightings.empty(); });
}

}  // namespace

bool marginaliseFrame(Window& window, std::int64_t serial, const std::set<std::int64_t>& landmarks,
                      const RigModel& rig, const WindowModel& model) {
  const int leaving = window.indexOf(serial);
  Window part = leavingPart(window, leaving, landmarks);
  const std::vector<int> frames = framesOf(part, leaving);
  const QuadraticCost all = WindowProblem(part, rig, model).reduced();

  std::vector<int> used, keep;
  Eigen::Index leaves = 0;  // first row of the frame that leaves, among those used
  WindowPrior prior;
  for (const int frame : frames) {
    if (frame == leaving) leaves = used.size();
    for (int k = 0; k < kState; ++k) {
      if (frame != leaving) keep.push_back(static_cast<int>(used.size()));
      used.push_back(kState * frame + k);
    }
    if (frame == leaving) continue;
    OdometryFrame& kept = window.frames[frame];
    if (!kept.first_estimate) kept.first_estimate = kept.state;
    prior.frames.push_back(kept.serial);
    prior.points.push_back(*kept.first_estimate);
  }
  std::optional<QuadraticCost> remaining;
  if (all.H.size() > 0) {
    QuadraticCost cost{all.H(used, used), all.b(used), all.c};
    // What the states alone cannot tell (a velocity without a link) must not stop the elimination.
    cost.H.diagonal().segment<kState>(leaves).array() += 1e-6;
    remaining = marginalised(cost, keep);
  }
  for (const std::int64_t id : landmarks) window.landmarks.erase(id);
  dropFrame(window, leaving);
  if (!remaining) {
    window.prior = {};
    return false;
  }
  // The cost is about where the states are; the prior's points are their first estimates.
  Eigen::VectorXd d(keep.size());
  for (std::size_t i = 0; i < prior.frames.size(); ++i) {
    const int frame = window.indexOf(prior.frames[i]);
    d.segment<kState>(kState * i) = boxminus(window.frames[frame].state, prior.points[i]);
  }
  prior.cost = remaining->at(-d);
  window.prior = std::move(prior);
  return true;
}

}  // namespace plumbline
