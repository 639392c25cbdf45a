// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "report/html/scene.h"

namespace plumbline::html_internal {

TimeNs timeOrigin(const CalibrationRecord& record) {
  // The earlier of both stages: their plots have one axis of time.
  std::vector<TimeNs> first;
  if (record.camera && !record.camera->frames.empty()) {
    first.push_back(record.camera->frames.front().t);
  }
  if (record.camera_imu && !record.camera_imu->frames.empty()) {
    first.push_back(record.camera_imu->frames.front().t);
  }
  return first.empty() ? 0 : *std::ranges::min_element(first);
}

StageView cameraView(const CalibrationRecord& record) {
  const CameraStageResult& s = *record.camera;
  return {"camera",    "Camera stage", s.cameras,         s.frames,
          s.residuals, s.summary,      timeOrigin(record)};
}

StageView cameraImuView(const CalibrationRecord& record) {
  const CameraImuStageResult& s = *record.camera_imu;
  return {"camera-imu", "Camera-IMU stage", s.cameras,         s.frames,
          s.residuals,  s.summary,          timeOrigin(record)};
}

std::vector<Transform> cameraPoses(const CameraImuStageResult& stage) {
  std::vector<Transform> T_FC0;
  for (const ImuState& state : stage.states) T_FC0.push_back(state.T_FS * stage.imu.T_SC0);
  return T_FC0;
}

std::vector<std::vector<double>> frameRmse(const StageView& stage) {
  const std::size_t frames = stage.frames.size();
  std::vector<std::vector<double>> sums(stage.cameras.size(), std::vector<double>(frames, 0));
  auto counts = sums;
  for (const CornerResidual& r : stage.residuals) {
    const auto camera = static_cast<std::size_t>(r.camera);
    const auto frame = static_cast<std::size_t>(r.frame);
    if (!r.used || camera >= sums.size() || frame >= frames) continue;
    sums[camera][frame] += static_cast<double>(r.error.squaredNorm());
    counts[camera][frame] += 1;
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    for (std::size_t f = 0; f < frames; ++f) {
      // Not 0 where a camera saw nothing: no error is no small error.
      sums[c][f] = counts[c][f] > 0 ? std::sqrt(sums[c][f] / counts[c][f]) : std::nan("");
    }
  }
  return sums;
}

std::vector<double> frameSeconds(const StageView& stage) {
  std::vector<double> seconds;
  seconds.reserve(stage.frames.size());
  for (const Frame& frame : stage.frames) seconds.push_back(secondsBetween(stage.origin, frame.t));
  return seconds;
}

}  // namespace plumbline::html_internal
