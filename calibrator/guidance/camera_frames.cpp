// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/format.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/guidance/guide_stage.h"
#include "calibrator/initialise/camera_start.h"

namespace plumbline {
namespace {

// Over the image's width, for errors of a young estimate grow with it. A first pose is robust at a
// scale (kRoughLoss) far above noise, settles where no better start is worth trying (kGoodPose),
// and is refused where the cameras cannot be blamed for it (kWorstPose: 11 px of 752).
constexpr double kRoughLoss = 0.01;
constexpr double kGoodPose = 0.005;
constexpr double kWorstPose = 0.015;

// Of StartCheck.
constexpr std::size_t kFirstCheck = 10;
// Noise, and a model that misfits (EuRoC, radtan without loss), make it up to 1.01.
constexpr double kWorseStart = 1.25;

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

bool StartCheck::isDue(const GuideFrame& frame, const FrameCorners& corners) {
  if (frames_.size() >= 4 * kFirstCheck) return false;
  const double move_px = options_.views.start_move_px;
  if (!frames_.empty() && !hasMoved(frames_.back().corners, corners, move_px)) return false;
  frames_.push_back({frame.index, frame.t, corners});
  const std::size_t n = frames_.size();
  // Each after twice as many, so that all checks together cost less than two of the last.
  return n == kFirstCheck || n == 2 * kFirstCheck || n == 4 * kFirstCheck;
}

std::optional<std::string> StartCheck::against(
    const std::vector<CameraCalibration>& cameras) const {
  const auto restart = calibrateFrames(rig_, frames_, options_);
  const auto given = scoreFrames(rig_, frames_, options_, cameras);
  if (!restart || !given) return std::nullopt;
  // Scored as the given ones are, for a calibration leaves out corners that a score does not.
  const auto scored = scoreFrames(rig_, frames_, options_, restart->cameras);
  if (!scored) return std::nullopt;
  const double restart_px = scored->summary.reprojection.rmse_px;
  const double given_px = given->summary.reprojection.rmse_px;
  // Cameras made from these very frames fit them better than any others: only a clear excess blames
  // the start.
  if (!(given_px > kWorseStart * std::max(restart_px, kNoiseFloorPx))) return std::nullopt;
  return fmt::format(
      "the estimate has {:.2f} px RMSE on {} frames after its start, an estimate from those frames "
      "alone {:.2f} px",
      given_px, frames_.size(), restart_px);
}

}  // namespace plumbline
