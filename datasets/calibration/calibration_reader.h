// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {

/// Whether the file is Basalt's calibration.json: everything below `value0`.
bool isBasaltCalibration(const YamlMap& file);

/// T_imu_cam[i] (px py pz, Hamilton qx qy qz qw) = T_SCi; cam_time_offset_ns = our time offset;
/// noise as continuous-time densities, the largest of the axes. Camera types pinhole,
/// pinhole-radtan8 with k3 to k6 zero, kb4 (equidistant), ds, eucm, and ucm as Kalibr's omni (xi =
/// alpha / (1 - alpha), focal lengths times 1 + xi). Scale, misalignment and biases of the IMU are
/// not read. InputError for other types and quaternions that are not of unit length to 1e-3.
Calibration readBasaltCalibration(const YamlMap& file);

/// What was simplified in reading it, a sentence each: densities that differ between the axes,
/// scale and misalignment of the IMU.
std::vector<std::string> basaltRemarks(const YamlMap& file);

/// Whether the file is a result of yac (github.com/chutsu/yac): its cameras have `proj_model`.
bool isYacResult(const YamlMap& file);

/// Cameras camN with proj_model, dist_model ("radtan4", "equi4"), proj_params, dist_params and
/// T_cam0_camN = T_C0CN (OpenCV matrices). With an imu0 section: T_imu0_cam0 = T_SC0, time_delay
/// [s] = our time offset, g [m/s^2], and sigma_g_c, sigma_gw_c, sigma_a_c, sigma_aw_c as
/// continuous-time densities.
/// Not read: ba and bg, whose labels are swapped in what yac writes (what it calls ba is the
/// gyroscope's bias and the reverse), and the poses.
Calibration readYacResult(const YamlMap& file);

/// What a calibration's file says beside the calibration itself.
struct CalibrationExtras {
  std::string tool;  ///< who wrote it: "plumbline", "kalibr", "openvins", "yac", "basalt"
  /// Ours: of the last stage that estimated the cameras; names as in the file ("cam0.fu").
  std::optional<ParameterCovariance> cameras = {};
  std::string input = {};       ///< ours: name of the session that it was estimated from
  std::string input_hash = {};  ///< and its hash, "algorithm:hex"
  std::vector<std::string> camera_hashes = {};  ///< and of what each of its cameras recorded
  std::vector<std::string> remarks = {};  ///< on what calibration() simplified, a sentence each
};

/// A calibration's file, parsed once: ours (calibration.json), Kalibr's (camchain*.yaml), OpenVINS'
/// (kalibr_imucam_chain.yaml), yac's (its results of camera and of camera-IMU calibration) or
/// Basalt's (calibration.json, all below value0), told by its content.
class CalibrationFile {
 public:
  /// Throws InputError, with file and line, for a file that cannot be parsed.
  explicit CalibrationFile(const std::string& path);

  const std::string& path() const { return map_.path(); }

  /// Kalibr: T_cam_imu maps IMU to camera, T_cn_cnm1 the previous camera to this one; a chain is
  /// resolved to T_C0Ci. The IMU is there if a camera has T_cam_imu; the time offset is that of
  /// camera 0, with those of all where they differ. Its noise is not in that file (see
  /// datasets/calibration/kalibr/run.h for all files of a run).
  /// yac: T_cam0_cam1 and T_imu0_cam0 are our T_C0C1 and T_SC0, time_delay our time offset
  /// (imu_timestamp = camera_timestamp + time_delay); densities sigma_*_c are continuous-time ones.
  /// Throws InputError, with file and line, for a file that is none of these, missing keys,
  /// transforms that are not rigid or contradict each other by more than 1 mm or 0.1 degrees, a
  /// rolling shutter (line_delay), and models whose number of parameters is wrong.
  Calibration calibration() const;

  /// Whether it states the noise densities of its IMU: ours, yac's and Basalt's do, Kalibr's and
  /// OpenVINS' camchain do not (ImuCalibration::noise is then its default).
  bool statesImuNoise() const;

  /// Whether it states a time offset: Kalibr's and OpenVINS' camchain may leave it out
  /// (ImuCalibration::time_offsets is then 0). Throws InputError as calibration() does.
  bool statesTimeOffset() const;

  /// Whether it states where several cameras lie to the IMU beside where they lie to each other
  /// (Kalibr's T_cam_imu and T_cn_cnm1), which agree. Throws InputError as calibration() does.
  bool statesImuPlacesTwice() const;

  /// Throws InputError, with file and line, for a covariance that is not square or does not fit its
  /// list of parameters.
  CalibrationExtras extras() const;

  /// What it states of its parameters ("cam0.fu", "T_SC0.tx", "time_offset"): ours, robust where
  /// the stage has them (`robust_std`, `robust_dof`), else formal. Empty for other tools' files.
  /// Throws InputError as extras() does.
  StatedDeviations deviations() const;

 private:
  YamlMap map_;
};

/// CalibrationFile::calibration() of a file of which nothing else is asked.
Calibration readCalibration(const std::string& path);

}  // namespace plumbline
