// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"
#include "evaluate/studies/perturbation_study.h"
#include "report/records/perturbation_record.h"

namespace plumbline {

/// What `plumbline perturb` is asked to do.
struct PerturbRequest {
  LoadRequest load;
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
  std::optional<std::string> cameras_file;  ///< used as they are; empty: calibrated first
  std::vector<Perturbation> perturbations;
  int threads = 0;  ///< cases that run at once; 0: all cores
  PerturbationThresholds thresholds;
  Provenance provenance;  ///< input and hash are filled in
};

/// Loads the session once (detection included), and runs perturbationStudy() on it. Throws
/// InputError for bad input; fails where the base calibration does.
Result<PerturbationRecord> perturbSession(const PerturbRequest& request,
                                          const ProgressSink& progress);

}  // namespace plumbline
