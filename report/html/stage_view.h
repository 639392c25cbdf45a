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
  TimeNs origin = 0;  ///< where the page's time starts
};

/// Where the page's time starts: at the first frame of either stage, so that all plots over time
/// have one axis. 0 without frames.
TimeNs timeOrigin(const CalibrationRecord& record);

/// The stages of a record that has them.
StageView cameraView(const CalibrationRecord& record);
StageView cameraImuView(const CalibrationRecord& record);

/// RMSE of the used corners per camera and frame [px], NaN where a camera has none.
std::vector<std::vector<double>> frameRmse(const StageView& stage);

/// Seconds of every frame since the page's time starts.
std::vector<double> frameSeconds(const StageView& stage);

}  // namespace plumbline::html_internal
