// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// One calibration as lint sees it.
struct LintedCalibration {
  std::string name;  ///< how messages name it: its file
  Calibration calibration;
  bool noise_known = false;  ///< whether imu->noise was in the file
  bool offset_known = true;  ///< whether imu->time_offsets was
  /// Whether the file has T_cam_imu of several cameras, which agree with T_cn_cnm1 as they stand:
  /// inverted one by one they would not, so that it takes a recording's lever arm to call them so.
  bool imu_places_agree = false;
};

class CalibrationFile;

/// A calibration that was read from `file` under that file's name, with what the file itself
/// states; an imu.yaml beside Kalibr's camchain is not looked at.
LintedCalibration lintedFrom(const CalibrationFile& file, Calibration calibration);

/// Looks for mistakes of convention and of units in calibrations of one rig: each by itself, and,
/// where there are several, against each other. One finding for each fault, none for clean files;
/// `advice` names file and field. Rules: see docs/conventions.md. Pure; deterministic.
///
/// "Inverted transform", "Flipped time offset", "Order of cameras", "Inverted baseline" between two
/// files cannot say which one is wrong; of three or more, the one that differs from the majority is
/// named.
std::vector<Finding> lintCalibrations(std::span<const LintedCalibration> calibrations);

/// Holds calibrations, their cameras as matchCalibration() gives them, against a recording of their
/// rig: order of cameras, and, where it has an IMU, its columns and units, direction of T_SC0, sign
/// of the time offset and noise.
/// Poses come from the corners and each calibration's cameras; nothing is calibrated.
std::vector<Finding> lintAgainstSession(std::span<const LintedCalibration> calibrations,
                                        const Session& session);

}  // namespace plumbline
