// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/corners.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {

/// Throws InputError for a session without cameras, or whose resolution is unknown.
void checkSession(const Session& session);
/// Throws InputError unless there is one calibration for each camera of the session.
void checkCameras(const Session& session, const std::vector<CameraCalibration>& cameras);

/// Measurements and solver under the stage's options.
CameraProblem problemOf(const std::vector<PackedCorners>& corners, std::vector<Frame> frames,
                        const CameraStageOptions& options);
MinimiserOptions solverOptions(const CameraStageOptions& options);

/// Frames that have a pose, and the estimate to start the batch from.
struct CameraStart {
  std::vector<Frame> frames;
  CameraEstimate estimate;
};

/// From the views alone: each camera's focal length, a first solution of each camera on some of its
/// views, a pose of every view, extrinsics over the graph of cameras that share frames, and one
/// pose for every frame. Frames without a plausible pose are left out.
/// With ModelMode::kAuto `models` say nothing: each camera gets one that leads near any lens.
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

/// Fills covariance, its entropy, and the cameras' standard deviations from the reduced information
/// `information` (in units of pixel_sigma). Fails with kNotObservable where a direction of the
/// parameters is free, naming it: one whose standard deviation makes its parameters worthless
/// (focal length 20 %, principal point 20 % of the width, distortion 10, translation 1 m,
/// rotation 1 rad).
std::optional<Failure> addCovariance(const Eigen::MatrixXd& information, CameraStageResult& result);

/// Cameras, frames and poses T_FC0 of an estimate, under the session's names.
CameraStageResult resultFrom(const Session& session, const CameraProblem& problem,
                             const CameraEstimate& estimate);

/// Lists every corner of the problem's frames with its residual (rejected ones marked), and fills
/// the statistics, counts and what was offered. Without a list, only statistics and counts.
enum class ResidualList { kKeep, kDrop };
void addResiduals(const Session& session, const CameraProblem& problem,
                  const CameraEstimate& estimate, ResidualList list, CameraStageResult& result);

/// What the cameras see in a frame.
std::vector<FrameView> frameViews(const Frame& frame, std::span<const PackedCorners> corners,
                                  const CameraEstimate& cameras);

/// rmsWidth() of all corners in the problem's frames.
double rmsWidth(const CameraProblem& problem, const CameraEstimate& cameras);

/// Every frame's pose where its own corners want it, cameras and board fixed.
struct RefinedPoses {
  std::vector<double> cost;  ///< per frame: sum of rho(|e|^2) [px^2]
  bool converged = false;    ///< all of them
};
RefinedPoses refinePoses(const CameraProblem& problem, CameraEstimate& estimate);

/// Corners that an estimate puts beyond an angle from the optical axis, of lenses that end there.
std::vector<CornerPlace> cornersBeyond(const CameraProblem& problem, const CameraEstimate& estimate,
                                       double angle_rad);
/// Corners of tags that do not stand where their ids belong.
std::vector<CornerPlace> misplacedCorners(const AprilGrid& target, const CameraProblem& problem,
                                          const CameraEstimate& estimate);
/// One round of options.filter; returns how many corners it rejected.
std::size_t rejectCorners(const CameraProblem& problem, const CameraEstimate& estimate,
                          const CameraStageOptions& options, std::vector<PackedCorners>& corners);

/// The problem and estimate with only the frames that `keep` names (ascending).
void keepFrames(const std::vector<int>& keep, CameraProblem& problem, CameraEstimate& estimate);
/// Frames whose corners were not all but rejected.
std::vector<int> framesWithCorners(const CameraProblem& problem);
/// Keeps only those.
void dropBareFrames(CameraProblem& problem, CameraEstimate& estimate);

/// Moves the corners onto the board that an estimate has terms of; nothing where it has none.
void placeCorners(AprilGrid board, const CameraEstimate& estimate,
                  std::vector<PackedCorners>& corners);

/// The frames of a solved problem that a selection keeps, ascending; see ViewSelectionOptions. By
/// predicted error all of them where they do not determine the cameras, or none fits.
std::vector<int> selectFrames(const CameraProblem& problem, const CameraEstimate& estimate,
                              const ViewSelectionOptions& options);

/// Everything that is reported of a solution. A free direction explains a solver that did not
/// converge better than the solver could, so it is looked for first, and then a weak one will do.
Result<CameraStageResult> stageResult(const Session& session, const CameraProblem& problem,
                                      const CameraSolution& solution, ResidualList list);

}  // namespace plumbline
