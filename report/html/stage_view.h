// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// What both stages have in common, for the figures that both get.
struct StageView {
  std::string id;     ///< "camera", "camera-imu": prefix of ids in the page
  std::string title;  ///< "Camera stage"
  const std::vector<CameraCalibration>& cameras;
  const std::vector<Frame>& frames;
  const std::vector<CornerResidual>& residuals;
  const StageSummary& summary;
};

inline StageView viewOf(const CameraStageResult& s) {
  return {"camera", "Camera stage", s.cameras, s.frames, s.residuals, s.summary};
}

inline StageView viewOf(const CameraImuStageResult& s) {
  return {"camera-imu", "Camera-IMU stage", s.cameras, s.frames, s.residuals, s.summary};
}

/// RMSE of the used corners per camera and frame [px], NaN where a camera has none.
std::vector<std::vector<double>> frameRmse(const StageView& stage);

/// Seconds of every frame since the first.
std::vector<double> frameSeconds(const std::vector<Frame>& frames);

}  // namespace plumbline::html_internal
