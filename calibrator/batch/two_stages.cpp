// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/two_stages.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calibrator/batch/camera/problem.h"

namespace plumbline {

namespace {

/// J for so many parameters, of the cameras or of these and the board's terms.
std::optional<Eigen::MatrixXd> responseTo(const CameraImuStageResult& stage, Eigen::Index n) {
  if (!stage.faults || stage.faults->by_cameras.size() == 0) return std::nullopt;
  const Eigen::MatrixXd& J = stage.faults->by_cameras;
  const Eigen::Index cameras = J.cols() - kBoardTerms;  // tag_edge moves no pose
  // Of another rig, or with parameters that J does not know.
  if (n != cameras && n != cameras + kTargetTerms) return std::nullopt;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(J.rows(), n);
  const Eigen::Index moving = std::min(n, J.cols());
  out.leftCols(moving) = J.leftCols(moving);
  return out;
}

}  // namespace

std::optional<RobustDeviations> robustDeviationsOfBothStages(
    const CameraStageResult& camera, const CameraImuStageResult& camera_imu) {
  if (!camera.robust_covariance) return std::nullopt;
  // The same corners are displaced in both stages, and poses stay where the cameras take the whole
  // displacement: what that part would add alone is no bound of either side.
  const RobustCovariance cameras = camera.robust_covariance->withoutCommon();
  const auto J = responseTo(camera_imu, cameras.matrix.rows());
  if (!J || !camera_imu.faults->robust_dof) return std::nullopt;
  const FaultDiagnosis& own = *camera_imu.faults;
  RobustDeviations out{Eigen::VectorXd(J->rows()), Eigen::VectorXd(J->rows())};
  for (Eigen::Index k = 0; k < J->rows(); ++k) {
    const double v = own.robust_std(k) * own.robust_std(k);
    // Variances, not deviations: the two errors are independent (two_stages.h).
    const EstimatedVariance both =
        sumOf({v, (*own.robust_dof)(k)}, cameras.variance(J->row(k).transpose()));
    out.std(k) = std::sqrt(both.value);
    out.dof(k) = both.dof;
  }
  return out;
}

std::vector<FrameSegment> segmentsAtTheSameTime(const std::vector<FrameSegment>& segments,
                                                const std::vector<Frame>& other_frames,
                                                const std::vector<Frame>& frames) {
  const auto count = static_cast<int>(other_frames.size());
  const auto indexAt = [&](int other) {
    // Frames of one stage before the other's first one, or behind its last, belong to the segments
    // at the ends.
    if (other == 0) return 0;
    if (other == count) return static_cast<int>(frames.size());
    const TimeNs from = other_frames[other].t;
    const auto at = std::ranges::lower_bound(frames, from, {}, &Frame::t);
    return static_cast<int>(at - frames.begin());
  };
  std::vector<FrameSegment> out;
  for (const FrameSegment& segment : segments) {
    const int first = indexAt(segment.first);
    const int end = indexAt(segment.first + segment.count);
    // The stages keep other frames, so that a segment may have none here.
    if (end > first) out.push_back({first, end - first, segment.weight});
  }
  return out;
}

Result<ResampleSummary> resampleBothStages(const Session& session, const CameraStageResult& camera,
                                           const CameraImuStageResult& camera_imu,
                                           const ResampleOptions& resample,
                                           const CameraStageOptions& camera_options,
                                           const CameraImuOptions& camera_imu_options) {
  CameraStageOptions one_thread = camera_options;
  // Draws run beside each other.
  one_thread.threads = 1;
  const auto draw = [&](const std::vector<FrameSegment>& segments) {
    std::optional<HeldCameras> held;
    const auto again = recalibrateCameras(
        session, camera, segmentsAtTheSameTime(segments, camera_imu.frames, camera.frames),
        one_thread);
    if (again && again->summary.converged) held = {again->cameras, again->target};
    return held;
  };
  return resampleCameraImu(session, camera_imu, resample, camera_imu_options, draw);
}

}  // namespace plumbline
