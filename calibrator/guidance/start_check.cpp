// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/start_check.h"

#include <algorithm>

#include <fmt/format.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/initialise/camera_start.h"

namespace plumbline {
namespace {

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
