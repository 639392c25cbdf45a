// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>

#include "calibrator/base/calibration.h"
#include "evaluate/odometry/judged_run.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// By how much each parameter of a calibration is moved, in the order of calibrationParameters();
/// NaN or 0: not at all.
struct SensitivitySteps {
  Eigen::VectorXd steps;
  bool both_ways = true;  ///< by + and - the step; else the way to another calibration
};

/// Steps by the deviations that the calibration's file states (CalibrationFile::deviations():
/// robust where they are known), by name. Empty where it states none.
std::optional<SensitivitySteps> deviationSteps(const Calibration& calibration,
                                               const StatedDeviations& deviations);

/// The ATE (RMSE of positions [m]) that the odometry has with a calibration; empty where it fails.
using AteOfCalibration = std::function<std::optional<double>(const Calibration&)>;

/// That of the built-in odometry on a sequence. Keeps its estimate in `folder` meanwhile.
std::optional<double> ateOf(const OdometrySequence& sequence, const Calibration& calibration,
                            const SequenceTruth& truth, const OdometryRequest& request,
                            const std::filesystem::path& folder);

/// How the ATE changes with every parameter moved by itself:
///   change_i = ate(c + s_i e_i) - ate(c), or the mean of this and of - s_i,
/// and with all of them moved at once (one way only), whose rest after the sum is interaction. The
/// noise is the standard deviation of the ATE over 5 random moves of 1e-3 of the steps: an odometry
/// takes other tracks for a hair's breadth, and smaller changes mean nothing. Does not depend on
/// threads; `ate` is called from several at once. sequence, calibration and towards are the
/// caller's.
CalibrationSensitivity sensitivityOf(const Calibration& calibration, const SensitivitySteps& steps,
                                     const AteOfCalibration& ate, int threads,
                                     const ProgressSink& progress);

}  // namespace plumbline
