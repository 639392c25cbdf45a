// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/frames.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

namespace plumbline {
namespace {

struct Stamp {
  TimeNs t;
  int camera;
  int view;
};

std::vector<Stamp> usableViews(const std::vector<CameraStream>& cameras, int min_corners) {
  std::vector<Stamp> stamps;
  for (int c = 0; c < static_cast<int>(cameras.size()); ++c) {
    const auto& views = cameras[c].views;
    for (int v = 0; v < static_cast<int>(views.size()); ++v) {
      if (static_cast<int>(views[v].corners.size()) >= min_corners) {
        stamps.push_back({views[v].t, c, v});
      }
    }
  }
  std::sort(stamps.begin(), stamps.end(), [](const Stamp& a, const Stamp& b) {
    return std::tie(a.t, a.camera) < std::tie(b.t, b.camera);
  });
  return stamps;
}

// Candidate joins of neighbouring stamps, closest first: union of stamps into frames that hold each
// camera at most once and span at most the tolerance.
struct Group {
  std::vector<int> members;  // indices into the stamps
};

bool mayJoin(const Group& a, const Group& b, const std::vector<Stamp>& stamps, TimeNs tolerance) {
  for (int i : a.members) {
    for (int j : b.members) {
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
  std::stable_sort(joins.begin(), joins.end(),
                   [](const Join& a, const Join& b) { return a.gap < b.gap; });
  std::vector<Group> groups(n);
  std::vector<int> group_of(n);
  for (int i = 0; i < n; ++i) {
    groups[i].members = {i};
    group_of[i] = i;
  }
  for (const Join& join : joins) {
    const int a = group_of[join.left];
    const int b = group_of[join.right];
    if (a == b || !mayJoin(groups[a], groups[b], stamps, tolerance)) continue;
    for (int member : groups[b].members) {
      group_of[member] = a;
      groups[a].members.push_back(member);
    }
    groups[b].members.clear();
  }
  return groups;
}

}  // namespace

std::vector<Frame> pairFrames(const std::vector<CameraStream>& cameras,
                              const FrameOptions& options) {
  const std::vector<Stamp> stamps = usableViews(cameras, options.min_corners);
  std::vector<Frame> frames;
  for (const Group& group : groupStamps(stamps, options.tolerance)) {
    if (group.members.empty()) continue;
    Frame frame;
    frame.view.assign(cameras.size(), -1);
    const TimeNs base = stamps[group.members.front()].t;
    TimeNs sum = 0;
    for (int i : group.members) {
      frame.view[stamps[i].camera] = stamps[i].view;
      sum += stamps[i].t - base;
    }
    frame.t = base + sum / static_cast<TimeNs>(group.members.size());
    frames.push_back(std::move(frame));
  }
  std::sort(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) {
    return std::tie(a.t, a.view) < std::tie(b.t, b.view);
  });
  return frames;
}

}  // namespace plumbline
