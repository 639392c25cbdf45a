// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/both_stages.h"

#include <cmath>
#include <utility>

#include "calibrator/batch/two_stages.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {

Result<CameraImuStageResult> convergedCameraImu(const Session& session,
                                                const std::vector<CameraCalibration>& cameras,
                                                const CameraImuOptions& options,
                                                const CameraStageResult* estimated) {
  auto found = calibrateCameraImu(session, cameras, options);
  if (!found) return found;
  if (!found->summary.converged) return notConverged(*found);
  if (!estimated) return found;
  CameraImuStageResult stage = std::move(found).value();
  if (auto both = robustDeviationsOfBothStages(*estimated, stage)) {
    stage.summary.robust_std = std::move(both->std);
    stage.summary.robust_dof = std::move(both->dof);
  }
  return stage;
}

StatedDeviations statedDeviations(const CalibrationRecord& record) {
  StatedDeviations out;
  for (const Stage stage : {Stage::kCamera, Stage::kCameraImu}) {
    for (const ParameterEstimate& p : parameterEstimates(record, stage)) {
      const StatedDeviation formal{p.std};
      const StatedDeviation robust{p.robust_std.value_or(0), p.robust_dof.value_or(formal.dof)};
      // Those of no degree of freedom say nothing.
      const bool known = std::isfinite(robust.std) && robust.std > 0 && robust.dof > 0;
      out[p.name] = known ? robust : formal;
    }
  }
  return out;
}

}  // namespace plumbline
