// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// One calibration as lint sees it.
struct LintedCalibration {
  std::string name;  ///< how messages name it: its file
  Calibration calibration;
  bool noise_known = false;  ///< whether imu->noise was in the file
  bool offset_known = true;  ///< whether imu->time_offsets was
  /// Whether the file has T_cam_imu of several cameras, which agree with T_cn_cnm1 as they stand:
  /// inverted they would not, so that T_cam_imu is not inverted.
  bool imu_places_agree = false;
};

struct LintOptions {
  double max_baseline_m = 5;   ///< between cameras, or from IMU to camera: more is another unit
  double max_lever_arm_m = 2;  ///< from IMU to camera, whatever carries them
  double device_lever_arm_m = 0.1;  ///< the same, within one device (their topics say so), ...
  double device_baselines = 2;      ///< ... unless this many of its longest baselines are longer
  double max_offset_s = 0.5;        ///< time offset; more is milliseconds
  double max_principal_shift =
      0.15;                          ///< of the principal point off the centre, of the image's size
  double max_gyro_density = 0.05;    ///< [rad/s/sqrt(Hz)]
  double max_accel_density = 1;      ///< [m/s^2/sqrt(Hz)]
  double same_rotation_rad = 0.05;   ///< up to which rotations count as equal
  double same_translation_m = 0.02;  ///< likewise of translations
  double flip_offset_s = 5e-4;       ///< offsets below this have no sign worth comparing
  double odd_lever_arm_m = 0.05;     ///< off the other calibrations' median
  double odd_factor = 3;             ///< and this many times their median distance from it
  double ratio_tolerance = 0.03;     ///< of ratios that unit mistakes leave, relative
  double offset_tolerance_s = 2e-3;  ///< of an offset against the session's correlation
  double rotation_tolerance_rad = 0.1;  ///< of T_SC0 against the session's rates
  double noise_factor = 5;  ///< of a stated density over what the samples' noise can be at most
};

/// Looks for mistakes of convention and of units in calibrations of one rig: each by itself, and,
/// where there are several, against each other. One finding for each fault, none for clean files;
/// `advice` names file and field. Rules: see docs/conventions.md. Pure; deterministic.
///
/// "Inverted transform", "Flipped time offset", "Order of cameras", "Inverted baseline" between two
/// files cannot say which one is wrong; of three or more, the one that differs from the majority is
/// named.
std::vector<Finding> lintCalibrations(std::span<const LintedCalibration> calibrations,
                                      const LintOptions& options = {});

/// Holds calibrations, their cameras as matchCalibration() gives them, against a recording of their
/// rig: order of cameras, and, where it has an IMU, its columns and units, direction of T_SC0, sign
/// of the time offset and noise.
/// Poses come from the corners and each calibration's cameras; nothing is calibrated.
std::vector<Finding> lintAgainstSession(std::span<const LintedCalibration> calibrations,
                                        const Session& session, const LintOptions& options = {});

}  // namespace plumbline
