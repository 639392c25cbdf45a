// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {

/// One camN of a camchain as the file states it: nothing resolved, nothing checked against others.
struct KalibrCamera {
  std::string name;      ///< "cam0", ...
  std::string rostopic;  ///< empty if the file does not say
  Intrinsics intrinsics;
  std::optional<Transform> T_cam_imu;       ///< IMU into this camera
  std::optional<Transform> T_cn_cnm1;       ///< the previous camera into this one
  std::optional<double> timeshift_cam_imu;  ///< t_imu = t_cam + shift [s]
  double line_delay_s = 0;                  ///< of a rolling shutter
  /// In the file, for faults at its lines. Constant: a node of YAML that another is assigned to
  /// would change in every copy.
  std::optional<const YamlMap> stated;
};

/// Kalibr's camchain*.yaml; also OpenVINS' kalibr_imucam_chain.yaml, whose T_imu_cam is inverted
/// here.
struct KalibrCamchain {
  std::string path;
  std::vector<KalibrCamera> cameras;

  /// Whether any camera has T_cam_imu.
  bool hasImu() const;
  /// Whether any camera has timeshift_cam_imu: Kalibr writes none under --no-time-calibration.
  bool statesTimeOffset() const;
  /// Whether a camera beside cam0 has T_cam_imu and T_cn_cnm1, which calibrationOf() holds against
  /// each other.
  bool statesImuPlacesTwice() const;
};

/// Reads cam0, cam1, ... Throws InputError, with file and line, for missing keys, numbers that are
/// not finite, transforms that are not rigid, and models whose number of parameters is wrong.
KalibrCamchain readKalibrCamchain(const std::string& path);

/// The same of a file that is parsed already.
KalibrCamchain kalibrCamchainOf(const YamlMap& file);

/// The rig that the chain describes. T_C0Ci follows T_cn_cnm1, or where that is missing T_cam_imu
/// and that of a camera before; the first T_cam_imu along the chain is the IMU's place;
/// time_offsets has each camera's shift, an own one where it differs from camera 0's
/// (meanTimeOffset() for their mean); 0 where no camera states one (statesTimeOffset()). The IMU's
/// noise is not in this file. Throws InputError for a rolling shutter, a camera without a place,
/// and transforms that contradict each other by more than 1 mm or 0.1 degrees; the message says
/// which one, read in the other direction, would agree.
Calibration calibrationOf(const KalibrCamchain& chain);

/// How T_cam_imu of camera `i` (> 0) and its T_cn_cnm1 contradict each other, and which of them,
/// read in the other direction, would agree.
struct ChainContradiction {
  double translation_m = 0;
  double rotation_rad = 0;
  enum class Suspect { kNone, kChain, kThisCamera, kPreviousCamera, kAllCameras };
  Suspect suspect = Suspect::kNone;
};
/// Empty where they agree to 1 mm and 0.1 degrees, or where one of them is missing.
std::optional<ChainContradiction> chainContradiction(const KalibrCamchain& chain, std::size_t i);

/// One IMU of Kalibr's imu.yaml, whatever its model: for comparing. What a calibration starts from
/// is read by readImuDescription(), which refuses models with scale and misalignment.
struct KalibrImu {
  std::string rostopic;
  /// Or "scale-misalignment", "scale-misalignment-size-effect"; OpenVINS': "kalibr", "rpng".
  std::string model = "calibrated";
  ImuNoise noise;  ///< continuous-time densities
  /// measured = M true + bias (accelerometer), M and g-sensitivity A [(rad/s)/(m/s^2)] of the gyro,
  /// and its frame C_gyro_i; missing for a calibrated IMU.
  std::optional<Eigen::Matrix3d> accel_M;
  std::optional<Eigen::Matrix3d> gyro_M;
  std::optional<Eigen::Matrix3d> gyro_A;
  std::optional<Eigen::Matrix3d> C_gyro_i;
  /// Whether OpenVINS' Tw, Ta, R_IMUtoGYRO, R_IMUtoACC or Tg (all of "kalibr" and "rpng", its words
  /// for the model) are not those of an IMU without faults.
  bool openvins_distorted = false;

  /// Whether the model has scale, misalignment, g-sensitivity or a turned gyroscope, which a
  /// Calibration has no place for.
  bool isDistorted() const;
};

/// The IMU of a mapping: below imuN:, or a flat file.
KalibrImu kalibrImu(const YamlMap& map, const std::string& rate_key = "update_rate");

struct KalibrImuFile {
  std::string path;
  bool wrapped = false;  ///< below imu0:, as Kalibr writes its results; false: flat, as its input
  std::vector<KalibrImu> imus;
};

/// Reads imu.yaml, flat or wrapped. Throws InputError, with file and line, for missing keys and
/// densities that are not positive.
KalibrImuFile readKalibrImus(const std::string& path);

}  // namespace plumbline
