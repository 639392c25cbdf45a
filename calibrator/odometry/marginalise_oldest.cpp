// SPDX-License-Identifier: BSD-3-Clause
#include <numeric>
#include <utility>

#include "calibrator/odometry/window_problem.h"

namespace plumbline {

namespace {

/// The part of the window that leaves: all its frames (so that indices stay), the link of the
/// oldest one, the landmarks that go, the prior.
Window leavingPart(const Window& window, const std::set<std::int64_t>& landmarks) {
  Window part;
  part.frames = window.frames;
  part.prior = window.prior;
  for (std::size_t i = 1; i < part.frames.size(); ++i) {
    // All other terms stay in the window: in the prior as well they would count twice.
    part.frames[i].link.reset();
    part.frames[i].still = false;
  }
  for (const std::int64_t id : landmarks) {
    const auto landmark = window.landmarks.find(id);
    if (landmark != window.landmarks.end()) part.landmarks.insert(*landmark);
  }
  return part;
}

/// Which frames have terms in `part`; the oldest always.
std::set<int> framesOf(const Window& part) {
  std::set<int> frames{0};
  for (const std::int64_t serial : part.prior.frames) frames.insert(part.indexOf(serial));
  if (part.frames.size() > 1 && part.frames[0].link) frames.insert(1);
  for (const auto& [id, landmark] : part.landmarks) {
    if (!isUsed(landmark)) continue;
    for (const LandmarkSighting& s : landmark.sightings) frames.insert(part.indexOf(s.frame));
  }
  return frames;
}

}  // namespace

bool marginaliseOldest(Window& window, const std::set<std::int64_t>& landmarks, const RigModel& rig,
                       const WindowModel& model) {
  Window part = leavingPart(window, landmarks);
  const std::set<int> frames = framesOf(part);
  const QuadraticCost all = WindowProblem(part, rig, model).reduced();
  std::vector<int> used;
  WindowPrior prior;
  for (const int frame : frames) {
    for (int k = 0; k < kState; ++k) used.push_back(kState * frame + k);
    if (frame == 0) continue;
    OdometryFrame& kept = window.frames[frame];
    if (!kept.first_estimate) kept.first_estimate = kept.state;
    prior.frames.push_back(kept.serial);
    prior.points.push_back(*kept.first_estimate);
  }
  std::optional<QuadraticCost> remaining;
  if (all.H.size() > 0) {
    QuadraticCost cost{all.H(used, used), all.b(used), all.c};
    // What the states alone cannot tell (a velocity without a link) must not stop the elimination.
    cost.H.diagonal().head<kState>().array() += 1e-6;
    std::vector<int> keep(used.size() - kState);
    std::iota(keep.begin(), keep.end(), kState);
    remaining = marginalised(cost, keep);
  }
  for (const std::int64_t id : landmarks) window.landmarks.erase(id);
  window.dropFrame(0);
  window.prior = remaining ? std::move(prior) : WindowPrior();
  // The cost is about where the states are; the prior's points are their first estimates.
  if (remaining) window.prior.cost = remaining->at(-displacements(window));
  return remaining.has_value();
}

}  // namespace plumbline
