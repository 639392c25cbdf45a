// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// What a calibration's file says beside the calibration itself.
struct CalibrationExtras {
  std::string tool;  ///< who wrote it: "plumbline", "kalibr", "openvins", "yac", "basalt"
  /// Ours: of the last stage that estimated the cameras; names as in the file ("cam0.fu").
  std::optional<ParameterCovariance> cameras;
  std::string input;       ///< ours: name of the session that it was estimated from
  std::string input_hash;  ///< and its hash, "algorithm:hex"
};

/// Reads them from a file that readCalibration() reads. Throws InputError, with file and line, for
/// a covariance that is not square or does not fit its list of parameters.
CalibrationExtras readCalibrationExtras(const std::string& path);

}  // namespace plumbline
