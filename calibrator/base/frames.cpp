// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/frames.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

constexpr std::size_t kFewestForConstant = 10;  // stamps from which a constant shift is taken

struct Stamp {
  TimeNs t;  // less the camera's constant shift
  int camera;
  int view;
};

// Stamp of the reference nearest to each of the camera's stamps, as differences.
std::vector<TimeNs> nearestDifferences(const std::vector<TimeNs>& stamps,
                                       const std::vector<TimeNs>& reference) {
  std::vector<TimeNs> differences;
  for (const TimeNs t : stamps) {
    auto next = std::lower_bound(reference.begin(), reference.end(), t);
    if (next == reference.end() || (next != reference.begin() && t - *(next - 1) < *next - t)) {
      --next;
    }
    differences.push_back(t - *next);
  }
  return differences;
}

// The constant of pairFrames(); 0 where there is none or the tolerance does without. Half of the
// stamps must lie well within the tolerance about it; and from half of a frame interval on the
// nearest stamp is another frame's, from which a quarter keeps away.
TimeNs constantShift(const std::vector<TimeNs>& stamps, const std::vector<TimeNs>& reference,
                     TimeNs tolerance) {
  // Too few may agree by chance.
  if (std::min(stamps.size(), reference.size()) < kFewestForConstant) return 0;
  std::vector<TimeNs> differences = nearestDifferences(stamps, reference);
  const TimeNs shift = middleOf(differences);
  // Pairing bridges it as it is.
  if (std::llabs(shift) <= tolerance) return 0;
  for (TimeNs& d : differences) d = std::llabs(d - shift);
  std::vector<TimeNs> intervals;
  for (std::size_t i = 1; i < reference.size(); ++i) {
    intervals.push_back(reference[i] - reference[i - 1]);
  }
  const bool is_constant = 2 * middleOf(std::move(differences)) < tolerance &&
                           4 * std::llabs(shift) <= middleOf(std::move(intervals));
  return is_constant ? shift : 0;
}

std::vector<TimeNs> usableStamps(const CameraStream& camera, int min_corners) {
  std::vector<TimeNs> stamps;
  for (const ImageView& view : camera.views) {
    if (static_cast<int>(view.corners.size()) >= min_corners) stamps.push_back(view.t);
  }
  return stamps;
}

std::vector<Stamp> usableViews(const std::vector<CameraStream>& cameras,
                               const FrameOptions& options) {
  std::vector<Stamp> stamps;
  std::vector<TimeNs> reference;
  if (!cameras.empty()) reference = usableStamps(cameras[0], options.min_corners);
  for (int c = 0; c < static_cast<int>(cameras.size()); ++c) {
    const auto& views = cameras[c].views;
    const TimeNs shift = c == 0 ? 0
                                : constantShift(usableStamps(cameras[c], options.min_corners),
                                                reference, options.tolerance);
    for (int v = 0; v < static_cast<int>(views.size()); ++v) {
      if (static_cast<int>(views[v].corners.size()) >= options.min_corners) {
        stamps.push_back({views[v].t - shift, c, v});
      }
    }
  }
  // All on one clock: what may be joined stands close together then.
  std::ranges::sort(stamps, {}, [](const Stamp& s) { return std::pair(s.t, s.camera); });
  return stamps;
}

// Candidate joins of neighbouring stamps, closest first: union of stamps into frames that hold each
// camera at most once and span at most the tolerance.
using Group = std::vector<int>;  // indices into the stamps

bool mayJoin(const Group& a, const Group& b, const std::vector<Stamp>& stamps, TimeNs tolerance) {
  // Every pair, or a chain of small gaps would make a frame that is longer than the tolerance.
  for (int i : a) {
    for (int j : b) {
      if (stamps[i].camera == stamps[j].camera) return false;
      if (std::llabs(stamps[i].t - stamps[j].t) > tolerance) return false;
    }
  }
  return true;
}

std::vector<Group> groupStamps(const std::vector<Stamp>& stamps, TimeNs tolerance) {
  struct Join {
    TimeNs gap;
    int left, right;
  };
  std::vector<Join> joins;
  const int n = static_cast<int>(stamps.size());
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n && stamps[j].t - stamps[i].t <= tolerance; ++j) {
      if (stamps[i].camera != stamps[j].camera) joins.push_back({stamps[j].t - stamps[i].t, i, j});
    }
  }
  // Among equal gaps in the order of the stamps: the same frames on every platform.
  std::ranges::stable_sort(joins, {}, &Join::gap);
  std::vector<Group> groups(n);
  std::vector<int> group_of(n);
  for (int i = 0; i < n; ++i) {
    groups[i] = {i};
    group_of[i] = i;
  }
  // The closest pairs first: a view that stands between two of another camera goes to the nearer
  // one.
  for (const Join& join : joins) {
    const int a = group_of[join.left];
    const int b = group_of[join.right];
    if (a == b || !mayJoin(groups[a], groups[b], stamps, tolerance)) continue;
    for (int member : groups[b]) {
      group_of[member] = a;
      groups[a].push_back(member);
    }
    // Left empty rather than erased: indices of groups stay what they are.
    groups[b].clear();
  }
  return groups;
}

}  // namespace

void FrameOptions::check() const {
  requireAtLeast(0, "frames.tolerance", static_cast<double>(tolerance));
  requireAtLeast(0, "frames.min_corners", min_corners);
}

std::vector<Frame> pairFrames(const std::vector<CameraStream>& cameras,
                              const FrameOptions& options) {
  options.check();
  const std::vector<Stamp> stamps = usableViews(cameras, options);
  std::vector<Frame> frames;
  for (const Group& group : groupStamps(stamps, options.tolerance)) {
    if (group.empty()) continue;
    Frame frame;
    frame.view.assign(cameras.size(), -1);
    for (int i : group) frame.view[stamps[i].camera] = stamps[i].view;
    frames.push_back(std::move(frame));
  }
  // A frame that camera 0 did not see is stamped on camera 0's clock all the same.
  const std::vector<TimeNs> shifts = stampShifts(cameras, frames);
  for (Frame& frame : frames) {
    std::size_t c = 0;
    while (frame.view[c] < 0) ++c;
    frame.t = cameras[c].views[static_cast<std::size_t>(frame.view[c])].t - shifts[c];
  }
  std::ranges::sort(frames, {}, [](const Frame& f) { return std::tie(f.t, f.view); });
  return frames;
}

std::vector<TimeNs> stampShifts(const std::vector<CameraStream>& cameras,
                                const std::vector<Frame>& frames) {
  std::vector<TimeNs> shifts(cameras.size(), 0);
  for (std::size_t c = 1; c < cameras.size(); ++c) {
    std::vector<TimeNs> differences;
    for (const Frame& frame : frames) {
      if (frame.view[0] < 0 || frame.view[c] < 0) continue;
      differences.push_back(cameras[c].views[static_cast<std::size_t>(frame.view[c])].t -
                            cameras[0].views[static_cast<std::size_t>(frame.view[0])].t);
    }
    // The median: a frame that was paired wrongly does not move it.
    if (!differences.empty()) shifts[c] = middleOf(std::move(differences));
  }
  return shifts;
}

ViewChoice viewsOf(const Session& session, const std::vector<Frame>& frames,
                   const std::vector<int>& wanted) {
  ViewChoice choice;
  for (const CameraStream& camera : session.cameras) choice.emplace_back(camera.views.size());
  for (const int index : wanted) {
    const Frame& frame = frames[static_cast<std::size_t>(index)];
    for (std::size_t c = 0; c < frame.view.size(); ++c) {
      if (frame.view[c] >= 0) choice[c][static_cast<std::size_t>(frame.view[c])] = true;
    }
  }
  return choice;
}

Session withoutViews(Session session) {
  for (CameraStream& camera : session.cameras) camera.views.clear();
  return session;
}

Session withFrames(const Session& session, const std::vector<Frame>& frames,
                   const std::vector<int>& wanted) {
  Session out = withoutViews(session);
  const ViewChoice choice = viewsOf(session, frames, wanted);
  for (std::size_t c = 0; c < out.cameras.size(); ++c) {
    out.cameras[c].views = chosen(session.cameras[c].views, choice[c]);
  }
  return out;
}

}  // namespace plumbline
