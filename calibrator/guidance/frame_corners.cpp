// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/frame_corners.h"

#include <algorithm>

namespace plumbline {
namespace {

// Over the image's width, for errors of a young estimate grow with it. A first pose is robust at a
// scale (kRoughLoss) far above noise, settles where no better start is worth trying (kGoodPose),
// and is refused where the cameras cannot be blamed for it (kWorstPose: 11 px of 752).
constexpr double kRoughLoss = 0.01;
constexpr double kGoodPose = 0.005;
constexpr double kWorstPose = 0.015;

}  // namespace

FrameCorners usableViews(const GuideFrame& frame, std::size_t cameras, int min_corners) {
  FrameCorners usable(cameras);
  for (std::size_t c = 0; c < cameras && c < frame.corners.size(); ++c) {
    if (static_cast<int>(frame.corners[c].size()) >= min_corners) usable[c] = frame.corners[c];
  }
  return usable;
}

bool seesNothing(const FrameCorners& corners) {
  return std::all_of(corners.begin(), corners.end(), [](const auto& view) { return view.empty(); });
}

bool hasMoved(const FrameCorners& before, const FrameCorners& now, double least_px) {
  for (std::size_t c = 0; c < now.size(); ++c) {
    // A camera that has lost the board says nothing of movement.
    if (now[c].empty()) continue;
    const auto distance = meanCornerDistance(before[c], now[c]);
    // Too few corners in common: another part of the board is in view.
    if (!distance || *distance > least_px) return true;
  }
  return false;
}

PackedFrame::PackedFrame(const AprilGrid& target, const FrameCorners& seen) {
  for (const std::vector<Corner>& camera : seen) {
    corners.emplace_back(target, std::vector<ImageView>{{0, camera}});
  }
}

std::vector<FrameView> PackedFrame::views(const CameraEstimate& cameras) const {
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const PackedView view = corners[c].view(0);
    if (view.count == 0) continue;
    views.push_back({&cameras.intrinsics[c], view, cameras.T_C0Ci[c].inverse()});
  }
  return views;
}

std::optional<Transform> poseOf(const AprilGrid& target, const CameraEstimate& cameras,
                                const FrameCorners& corners, double cauchy_px) {
  const PackedFrame packed(target, corners);
  const std::vector<FrameView> views = packed.views(cameras);
  const double width = rmsWidth(views);
  PoseRefinementOptions rough;
  rough.gram.cauchy_px = kRoughLoss * width;
  const auto found = findPose(views, kGoodPose * width, rough);
  if (!found || !(found->errorPx() < kWorstPose * width)) return std::nullopt;
  // From there under the window's own loss, which would not have led there from afar.
  PoseRefinementOptions fine;
  fine.gram.cauchy_px = cauchy_px;
  return refinePose(views, found->T_C0F, fine).T_C0F.inverse();
}

std::optional<double> meanCornerDistance(const std::vector<Corner>& a,
                                         const std::vector<Corner>& b) {
  constexpr int kLeast = 4;  // fewer corners in common say nothing of a view
  double sum = 0;
  int common = 0;
  // Ids ascend in both: one pass finds those in common.
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (i->id < j->id) {
      ++i;
    } else if (j->id < i->id) {
      ++j;
    } else {
      sum += (i->uv - j->uv).norm();
      ++common, ++i, ++j;
    }
  }
  if (common < kLeast) return std::nullopt;
  return sum / common;
}

}  // namespace plumbline
