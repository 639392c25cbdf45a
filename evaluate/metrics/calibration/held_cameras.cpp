// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/held_cameras.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/initialise/camera_start.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

// Caution at most: which of the two is wrong the recording does not say.
constexpr Bound kWorse{1.05, std::numeric_limits<double>::infinity()};

}  // namespace

std::vector<Finding> judgeHeldCameras(const CameraStageResult& held, const Session& session,
                                      const ScoreOptions& options) {
  Rule rule{"Cameras against this recording", "x", kWorse,
            "Cameras of the same models explain this recording better: focus, mount or board may "
            "have changed, or the calibration is off. Calibrate this recording, and compare the "
            "two (plumbline compare) on a third one."};
  Calibration calibration;
  calibration.cameras = held.cameras;
  if (!canBeCalibrated(calibration)) return {};
  CameraStageOptions free = withModelsOf(calibration, options.camera);
  free.start = held.cameras;
  const auto estimated = calibrateCameras(session, free);
  // Scored as the held ones are: a calibration leaves out corners that a score does not.
  const auto own = estimated ? scoreCameras(session, estimated->cameras, options.camera)
                             : Result<CameraStageResult>(estimated.failure());
  std::vector<Finding> findings;
  if (!own) {
    findings.push_back(notJudged(rule, "the recording by itself does not determine the cameras (" +
                                           problemOf(own.failure()) + ")"));
  } else {
    const double held_px = held.summary.reprojection.rmse_px;
    const double own_px = own->summary.reprojection.rmse_px;
    findings.push_back(above(rule, held_px / std::max(own_px, kNoiseFloorPx),
                             fmt::format("RMSE {:.4g} px, and {:.4g} px under cameras that are "
                                         "estimated from these corners",
                                         held_px, own_px)));
  }
  findings.back().subject = FindingSubject::kCameras;
  return findings;
}

}  // namespace plumbline
