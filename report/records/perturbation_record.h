// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline {

/// One calibration of a perturbation study.
struct PerturbationCase {
  std::string kind;        ///< "imu-shift", "target-size", "noise-density", "initial-intrinsics",
                           ///< "dropped-frames", "dropped-imu", "corner-noise"
  double amount = 0;       ///< how much, in `unit`
  std::string unit;        ///< "ms", "%", "px"
  std::uint64_t seed = 0;  ///< of what was drawn; 0: nothing was
  std::string problem;     ///< why it failed; empty if it did not
  double rmse_px = 0;
  int frames = 0;
  int iterations = 0;
  double time_offset_s = 0;  ///< recovered
  std::optional<double> time_offset_std_s;
  /// recovered - injected - base [s]; only where an offset was injected the middle term is not 0.
  double offset_error_s = 0;
  std::vector<double> values;   ///< of PerturbationRecord::parameters
  std::vector<double> changes;  ///< from the base's values, rotations as Log(R R_base^T) [rad]
  std::vector<double> changes_sigma;  ///< the same, over the base's standard deviations
};

/// A perturbation study: one base calibration, and one for every case.
struct PerturbationRecord {
  std::string name;
  Provenance provenance;
  Assumptions assumptions;
  Verdict verdict;
  std::vector<std::string> parameters;  ///< names as in ParameterCovariance
  std::vector<std::string> units;
  std::vector<double> base_std;  ///< of the base calibration
  double offset_bound_s = 1e-3;  ///< an injected offset counts as recovered within this
  PerturbationCase base;
  std::vector<PerturbationCase> cases;
};

}  // namespace plumbline
