// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/trajectory.h"
#include "datasets/calibration/kalibr/camchain.h"
#include "datasets/calibration/kalibr/imu_file.h"
#include "datasets/calibration/kalibr/results_text.h"

namespace plumbline {

enum class KalibrFileKind { kCamchain, kCamchainImu, kImu, kResultsCameras, kResultsImu, kPoses };

/// What a file is, by its content and never by its name; nothing where it is none of Kalibr's
/// outputs (a target, another tool's file) or cannot be read. Throws nothing.
std::optional<KalibrFileKind> kalibrFileKind(const std::string& path);

/// The files of one run of Kalibr: of the camera tool, of the camera-IMU tool, or of both.
struct KalibrRun {
  std::optional<KalibrCamchain> cameras;         ///< camera tool: no T_cam_imu
  std::optional<KalibrResults> results_cameras;  ///< its text
  std::optional<Trajectory> poses;               ///< its T_FC0
  std::optional<KalibrCamchain> camera_imu;      ///< camera-IMU tool
  std::optional<KalibrResults> results_imu;
  std::optional<KalibrImuFile> imu;
  /// One sentence for each file of the folder that looks like Kalibr's and was left out.
  std::vector<std::string> remarks;

  /// The result: the camera-IMU tool's if there is one, with the IMU's noise and topic from
  /// imu.yaml (or the noise from the text) and the standard deviations of the intrinsics from the
  /// camera tool's text where its values are these. Throws what calibrationOf() throws.
  Calibration calibration() const;
  /// Of the text that belongs to calibration(); empty without one.
  std::optional<KalibrResults> results() const;
};

/// Reads a folder, or a file and what belongs to it in its folder (subfolders are not searched).
/// Files belong together by content: a text to the camchain whose values it rounds, an imu.yaml to
/// the text whose densities it has. Throws InputError where the folder holds no camchain, or
/// camchains of several runs (then name one), and for the faults of the files that are read.
KalibrRun readKalibrRun(const std::string& path);

}  // namespace plumbline
