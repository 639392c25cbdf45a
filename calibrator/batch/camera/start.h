// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// Frames that have a pose, and the estimate to start the batch from.
struct CameraStart {
  std::vector<Frame> frames;
  CameraEstimate estimate;
};

/// From the views alone: each camera's focal length, a first solution of each camera on some of its
/// views, a pose of every view, extrinsics over the graph of cameras that share frames, and one
/// pose for every frame. Frames without a plausible pose are left out.
/// Fails with kTooFewViews or kNoOverlap.
Result<CameraStart> startFromViews(const Session& session, std::span<const PackedCorners> corners,
                                   const std::vector<Frame>& frames,
                                   const std::vector<CameraModelPair>& models,
                                   const CameraStageOptions& options);

/// The same with known cameras: only poses are looked for. Fails with kTooFewViews.
Result<CameraStart> startFromCameras(const std::vector<CameraCalibration>& cameras,
                                     std::span<const PackedCorners> corners,
                                     const std::vector<Frame>& frames,
                                     const CameraStageOptions& options);

}  // namespace plumbline
