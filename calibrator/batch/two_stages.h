// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/resample.h"

namespace plumbline {

/// Standard deviations of T_SC0 (3 m, 3 rad) and the time offset [s] through both stages,
/// cluster-robust in both:
///   sqrt(v_1 + v_2),   v_1 = robust_std^2 of the camera-IMU batch,   v_2 = diag(J C J'),
/// v_2 to first order what the uncertainty of cameras and board adds, which the camera-IMU batch
/// holds: J = d(T_SC0, offset)/d(cameras, terms) (FaultDiagnosis::by_cameras), C the covariance of
/// the cameras' parameters, or of these and the board's terms. It adds without cross terms: corners
/// reach T_SC0 through the poses of the target alone, while cameras and board are estimated from
/// what poses leave of the same corners, so that white noise in the two is uncorrelated (two-step
/// estimation: Murphy and Topel 1985). The corners' common error is not, and is left out. The
/// degrees of freedom are those of such a sum (sumOf()), of v_2 those of the rows of J as
/// combinations of cameras and board. Empty where either stage has no robust deviations, or J is
/// empty or of other cameras.
std::optional<RobustDeviations> robustDeviationsOfBothStages(
    const CameraStageResult& camera, const CameraImuStageResult& camera_imu);

/// resampleCameraImu() through both stages: every draw's segments of time are those of the
/// camera-IMU stage, and the camera batch is solved again on its own frames in them, from `camera`,
/// before the camera-IMU batch holds what it found, board included. So the spread of T_SC0 has the
/// cameras' in it. `session` has the board that the camera stage had. Where the camera-IMU batch
/// refines the cameras itself, it starts from them.
Result<ResampleSummary> resampleBothStages(const Session& session, const CameraStageResult& camera,
                                           const CameraImuStageResult& camera_imu,
                                           const ResampleOptions& resample,
                                           const CameraStageOptions& camera_options,
                                           const CameraImuOptions& camera_imu_options);

/// Segments of `frames` (by time) that lie where the given segments of `other_frames` do: each from
/// the stamp of its first frame to that of the first one behind it, the recording's ends included.
std::vector<FrameSegment> segmentsAtTheSameTime(const std::vector<FrameSegment>& segments,
                                                const std::vector<Frame>& other_frames,
                                                const std::vector<Frame>& frames);

}  // namespace plumbline
