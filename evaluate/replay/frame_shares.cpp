// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/frame_shares.h"

#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/corners.h"

namespace plumbline {

Result<FrameShares> frameShares(const Session& session,
                                const std::vector<CameraCalibration>& cameras,
                                const CameraStageOptions& options) {
  const auto scored = scoreCameras(session, cameras, options);
  if (!scored) return scored.failure();
  const std::vector<PackedCorners> corners =
      usedCorners(session, scored->frames, scored->residuals);
  CameraProblem problem;
  problem.corners = corners;
  problem.frames = scored->frames;
  problem.pixel_sigma = options.pixel_sigma;
  problem.gram = {options.cauchy_px, 0};
  problem.threads = options.threads;
  return FrameShares{scored->frames, frameInformation(problem, estimateOf(cameras, scored->T_FC0))};
}

}  // namespace plumbline
