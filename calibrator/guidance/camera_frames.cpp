// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/guidance/frame_gate.h"
#include "calibrator/guidance/open_suggestion.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

// Over the image's width, for errors of a young estimate grow with it. A first pose is robust at a
// scale (kRoughLoss) far above noise, settles where no better start is worth trying (kGoodPose),
// and is refused where the cameras cannot be blamed for it (kWorstPose: 11 px of 752).
constexpr double kRoughLoss = 0.01;
constexpr double kGoodPose = 0.005;
constexpr double kWorstPose = 0.015;

Session sessionOf(const GuideRig& rig, const std::vector<KeptFrame>& frames) {
  Session session;
  session.target = rig.target;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    CameraStream stream;
    stream.name = rig.cameras[c].name;
    stream.resolution = rig.cameras[c].resolution;
    for (const KeptFrame& frame : frames) {
      // Views of a frame keep its stamp, by which the batch pairs them again.
      if (!frame.corners[c].empty()) stream.views.push_back({frame.t, frame.corners[c]});
    }
    session.cameras.push_back(std::move(stream));
  }
  return session;
}

CameraStageOptions stageOptions(const GuideRig& rig, const GuideOptions& options) {
  CameraStageOptions stage;
  for (const GuideRig::Camera& camera : rig.cameras) stage.models.push_back(camera.model);
  stage.model() = options.views.model();
  stage.threads = options.threads;
  return stage;
}

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

std::optional<Transform> poseOf(const AprilGrid& target, const CameraEstimate& cameras,
                                const FrameCorners& corners, double cauchy_px) {
  std::vector<PackedCorners> packed;
  packed.reserve(corners.size());
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    // Also of a camera without corners, so that packed[c] is camera c's.
    packed.emplace_back(target, std::vector<ImageView>{{0, corners[c]}});
    if (corners[c].empty()) continue;
    views.push_back({&cameras.intrinsics[c], packed[c].view(0), cameras.T_C0Ci[c].inverse()});
  }
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

Result<CameraStageResult> calibrateFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                          const GuideOptions& options,
                                          const std::vector<CameraCalibration>& start) {
  CameraStageOptions stage = stageOptions(rig, options);
  stage.start = start;
  return calibrateCameras(sessionOf(rig, frames), stage);
}

Result<CameraStageResult> scoreFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                      const GuideOptions& options,
                                      const std::vector<CameraCalibration>& cameras) {
  return scoreCameras(sessionOf(rig, frames), cameras, stageOptions(rig, options));
}

}  // namespace plumbline
