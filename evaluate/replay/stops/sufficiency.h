// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "evaluate/metrics/calibration/distances.h"
#include "evaluate/replay/stops/stopping_rule.h"
#include "report/records/replay_record.h"

namespace plumbline {

// When the frames that a stage kept are sufficient, and what is said of it.

/// How far the cameras of some views are from those of all frames.
struct CameraShortfall {
  std::optional<double> held_out_px;
  Distance projection_px, translation_m, rotation_rad;  ///< the worst of all cameras
};

/// RMSE of frames under cameras that were not fitted to them, only poses moving [px]; empty where
/// no frame has a pose.
std::optional<double> heldOutError(const Session& held_out,
                                   const std::vector<CameraCalibration>& cameras,
                                   const CameraStageOptions& options);

CameraShortfall shortfallOf(const std::vector<CameraCalibration>& cameras,
                            const CameraStageResult& all_frames, const Session& held_out,
                            const CameraStageOptions& options);

/// What a camera stage's views must come to.
struct CameraBars {
  double stop_px = 0;  ///< ViewGuideOptions::stop_projection_px
  double held_out_px = 0;
  double projection_px = 0;
  StoppingRuleOptions options;  ///< for T_C0Ci

  /// With `stop_px` by that alone: by the measure that the stage stopped by, otherwise a stop would
  /// be judged by what it was not for.
  bool areMetBy(const CameraShortfall& s) const;
};

/// The bars of a batch over all frames whose held-out error is `best_px`: ratios to it, so that
/// they serve cameras with good corners and with poor ones.
CameraBars barsOf(double stop_px, double best_px, const StoppingRuleOptions& options);

/// "held-out error of the views kept by then 0.28 px on 200 frames, ...": a sentence's part.
std::string cameraWords(const CameraShortfall& kept, const CameraBars& bars, double best_px,
                        std::size_t frames, const StopAudit& audit);

/// Whether T_SC0 and time offset are within the bars.
bool isNear(const ImuDistance& d, const StoppingRuleOptions& options);

/// What is held against a stop by T_SC0 and time offset.
std::string armWords(const ImuDistance& d, const StoppingRuleOptions& options);

/// The same of a stop by the points that the IMU predicts.
std::string pointsWords(const Distance& points_px, const StopAudit& audit, double bar_px);

}  // namespace plumbline
