// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
SessionEstimate sessionEstimate(Session session, const std::vector<Calibration>& calibrations,
                                const ScoreOptions& options, TargetMode target,
                                const ComparisonThresholds& thresholds) {
  SessionEstimate own;
  own.session = session.name;
  if (!canBeCalibrated(calibrations.front())) {
    own.problem = "the first calibration's camera models can be scored but not calibrated";
    return own;
  }
  // The first one's models, so that parameters compare one by one.
  CameraStageOptions camera = withModelsOf(calibrations.front(), options.camera);
  camera.target = target;
  const auto cameras = calibrateCameras(session, camera);
  if (!cameras) {
    own.problem = problemOf(cameras.failure());
    return own;
  }
  own.calibration.cameras = cameras->cameras;
  // As calibrateSession() does: the board that the cameras were estimated with.
  session.target.shape = cameras->target;
  const bool imu = std::any_of(calibrations.begin(), calibrations.end(),
                               [](const Calibration& c) { return c.imu.has_value(); });
  if (imu && options.use_imu && session.imu) {
    // The camera stage fails where it does not converge; this one returns where it stopped, so it
    // is asked.
    const auto stage = calibrateCameraImu(session, cameras->cameras, options.camera_imu);
    if (stage && stage->summary.converged) {
      own.calibration.imu = stage->imu;
    } else {
      own.problem = "camera-IMU: " + problemOf(stage ? notConverged(*stage) : stage.failure());
    }
  }
  std::vector<Calibration> all = {own.calibration};
  all.insert(all.end(), calibrations.begin(), calibrations.end());
  own.parameters = comparedParameters(all, thresholds);
  return own;
}

}  // namespace plumbline
