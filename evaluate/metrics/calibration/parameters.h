// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// One parameter of a calibration as a person reads it.
struct CalibrationParameter {
  std::string
      name;  ///< as in ParameterCovariance: "cam0.fu", "T_C0C1.tx", "T_SC0.rz", "time_offset"
  std::string unit;
  double value = 0;           ///< rotations: component of the rotation vector Log(R) [rad]
  std::optional<double> std;  ///< where the calibration carries one
  std::optional<double> dof;  ///< of its square, where it is cluster-robust
};

/// All parameters: every camera's stacked intrinsics, then every T_C0Ci but the first, then T_SC0
/// and the time offset where there is an IMU. Cameras are named by their place ("cam0", ...), so
/// that the lists of two calibrations of one rig compare.
std::vector<CalibrationParameter> calibrationParameters(const Calibration& calibration);

/// The same under the cameras' own names, by which files state their deviations and people know
/// them: with --only they may not be those of their places.
std::vector<CalibrationParameter> namedParameters(const Calibration& calibration);

/// The calibration with these deviations in place of those it carries, by the names of
/// namedParameters(). What is not listed whole (a camera's intrinsics, a transform) keeps its own.
Calibration withDeviations(Calibration calibration, const StatedDeviations& stated);

/// to - from, in the order of calibrationParameters(): differences of numbers, and for transforms
/// the tangent boxminus(to, from) [m, rad], so that small rotations do not depend on where Log(R)
/// is cut. Empty (NaN) where a camera's model differs or only one of them has an IMU; the order is
/// that of `from`.
Eigen::VectorXd calibrationChange(const Calibration& to, const Calibration& from);

/// The inverse: `from` with all parameters moved by `change`, in the order of
/// calibrationParameters(): calibrationChange(changedBy(from, d), from) = d.
Calibration changedBy(Calibration from, const Eigen::VectorXd& change);

}  // namespace plumbline
