// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/two_stages.h"

#include <algorithm>
#include <cstddef>

namespace plumbline {

std::optional<Eigen::Matrix<double, 7, 7>> covarianceOfCameras(const CameraImuStageResult& stage,
                                                               const Eigen::MatrixXd& C) {
  constexpr Eigen::Index kBoard = kTargetTerms - 1;  // tag_edge moves no pose
  if (!stage.faults || stage.faults->by_cameras.size() == 0) return std::nullopt;
  const Eigen::MatrixXd& J = stage.faults->by_cameras;
  const Eigen::Index cameras = J.cols() - kBoard;
  Eigen::Index n = 0;
  if (C.rows() == cameras) n = cameras;
  if (C.rows() == cameras + kTargetTerms) n = J.cols();
  if (n == 0) return std::nullopt;
  return J.leftCols(n) * C.topLeftCorner(n, n) * J.leftCols(n).transpose();
}

std::optional<Eigen::VectorXd> robustStdOfBothStages(const CameraStageResult& camera,
                                                     const CameraImuStageResult& camera_imu) {
  const auto added = covarianceOfCameras(camera_imu, camera.robust_covariance);
  if (!added) return std::nullopt;
  const Eigen::Matrix<double, 7, 1> own = camera_imu.faults->robust_std.cwiseAbs2();
  return Eigen::VectorXd((own + added->diagonal()).cwiseSqrt());
}

std::vector<FrameSegment> segmentsAtTheSameTime(const std::vector<FrameSegment>& segments,
                                                const std::vector<Frame>& other_frames,
                                                const std::vector<Frame>& frames) {
  const auto count = static_cast<int>(other_frames.size());
  const auto indexAt = [&](int other) {
    if (other == 0) return 0;
    if (other == count) return static_cast<int>(frames.size());
    const TimeNs from = other_frames[static_cast<std::size_t>(other)].t;
    const auto at = std::lower_bound(frames.begin(), frames.end(), from,
                                     [](const Frame& frame, TimeNs t) { return frame.t < t; });
    return static_cast<int>(at - frames.begin());
  };
  std::vector<FrameSegment> out;
  for (const FrameSegment& segment : segments) {
    const int first = indexAt(segment.first);
    const int end = indexAt(segment.first + segment.count);
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
