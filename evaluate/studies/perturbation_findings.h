// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "evaluate/studies/perturbation_study.h"
#include "report/records/perturbation_record.h"

namespace plumbline {

/// The injected offsets around zero from which the calibration finds its way back.
struct ConvergenceBasin {
  double from_ms = 0;  ///< smallest injected offset of the unbroken range that holds 0
  double to_ms = 0;
  int inside = 0;  ///< cases in the range
  int failed = 0;  ///< offsets outside: not converged, or recovered worse than the bound
};

/// Basin of the cases "imu-shift" with |error| <= `bound_s`.
ConvergenceBasin convergenceBasin(const PerturbationRecord& record, double bound_s);

/// What a study says: offsets recovered, everything else unmoved under them; under each other kind
/// nothing moved by more than first order predicts from the estimate's covariance; cases that
/// failed. Only what the record has cases for.
std::vector<Finding> perturbationFindings(const PerturbationRecord& record,
                                          const PerturbationThresholds& thresholds);

}  // namespace plumbline
