// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/kept_frames.h"

namespace plumbline {
namespace {

Session sessionOf(const GuideRig& rig, const std::vector<KeptFrame>& frames) {
  Session session;
  session.target = rig.target;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    CameraStream stream;
    stream.name = rig.cameras[c].name;
    stream.resolution = rig.cameras[c].resolution;
    for (const KeptFrame& frame : frames) {
      if (!frame.corners[c].empty()) stream.views.push_back({frame.t, frame.corners[c]});
    }
    session.cameras.push_back(std::move(stream));
  }
  return session;
}

}  // namespace

Result<CameraStageResult> calibrateFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                          const GuideOptions& options,
                                          const std::vector<CameraCalibration>& start) {
  CameraStageOptions stage;
  for (const GuideRig::Camera& camera : rig.cameras) stage.models.push_back(camera.model);
  stage.start = start;
  stage.pixel_sigma = options.views.pixel_sigma;
  stage.cauchy_px = options.views.cauchy_px;
  stage.threads = options.threads;
  return calibrateCameras(sessionOf(rig, frames), stage);
}

}  // namespace plumbline
