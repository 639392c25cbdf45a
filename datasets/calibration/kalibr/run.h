// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "datasets/calibration/kalibr/camchain.h"
#include "datasets/trajectory/trajectory_reader.h"

namespace plumbline {

/// What the camera-IMU tool prints of one error: of the norms of its residuals.
struct KalibrErrorStatistics {
  double mean = 0;
  double median = 0;
  double std = 0;  ///< ddof 0

  /// Root mean square of the norm: sqrt(mean^2 + std^2), as the deviation has n in its denominator.
  double rms() const { return std::hypot(mean, std); }
};

/// What the camera tool prints of one camera's reprojection error, per axis [px].
struct KalibrAxisStatistics {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d std = Eigen::Vector2d::Zero();

  /// Root mean square of the error's norm: sqrt(mx^2 + my^2 + sx^2 + sy^2) [px].
  double rms() const { return std::sqrt(mean.squaredNorm() + std.squaredNorm()); }
};

struct KalibrTextCamera {
  std::string name;      ///< "cam0"
  std::string rostopic;  ///< empty in the camera-IMU tool's file
  // The camera tool's.
  std::optional<KalibrAxisStatistics> axis_error_px;
  Eigen::VectorXd projection, projection_std;  ///< in Kalibr's order, rounded; empty if not printed
  Eigen::VectorXd distortion, distortion_std;
  /// The previous camera into this one, from q and t of its baseline (q's order is not stated: x,
  /// y, z, w of the conjugate, as in poses-*.csv).
  std::optional<Transform> T_cn_cnm1;
  // The camera-IMU tool's.
  std::optional<KalibrErrorStatistics> error_px;  ///< missing in old versions
  std::optional<Transform> T_cam_imu;             ///< IMU into this camera, rounded
  std::optional<double> timeshift_cam_imu;        ///< t_imu = t_cam + shift [s]

  /// RMS of the reprojection error [px], of either tool; nothing where only normalised errors
  /// stand.
  std::optional<double> rmsPx() const;
};

/// results-*.txt. Parameter values are rounded here: take them from the YAML.
struct KalibrResults {
  enum class Tool { kCameras, kCameraImu };
  std::string path;
  Tool tool = Tool::kCameras;
  std::vector<KalibrTextCamera> cameras;
  std::optional<KalibrErrorStatistics> gyro_rad_s;  ///< missing in old versions
  std::optional<KalibrErrorStatistics> accel_m_s2;  ///< likewise
  std::optional<Eigen::Vector3d> gravity_F;         ///< in target coordinates [m/s^2]
  std::optional<ImuNoise> noise;                    ///< continuous-time densities
};

/// Reads the text of both tools, in their layouts since 2014. Throws InputError, with file and
/// line, for a file that is none, one that ends early, and results that are not finite (the
/// optimisation diverged).
KalibrResults readKalibrResults(const std::string& path);

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
  /// One sentence for each file of the folder that looks like Kalibr's and was left out, and for
  /// what is unusual in its poses.
  std::vector<std::string> remarks;

  /// The result: the camera-IMU tool's if there is one, with the IMU's noise and topic from
  /// imu.yaml (or the noise from the text) and the standard deviations of the intrinsics from the
  /// camera tool's text where its values are these. Throws what calibrationOf() throws.
  Calibration calibration() const;
  /// Of the text that belongs to calibration(); empty without one.
  std::optional<KalibrResults> results() const;
};

/// Reads a folder, or a file and what belongs to it in its folder (subfolders are not searched).
/// Files belong together by content: the camchains of both tools by their intrinsics, a text to the
/// camchain whose values it rounds, an imu.yaml to the text whose densities it has. A camchain that
/// is named decides which run it is. Throws InputError where the folder holds no camchain, or
/// camchains of several runs (then name one), and for the faults of that camchain; other files that
/// cannot be read are left out, with a remark.
KalibrRun readKalibrRun(const std::string& path);

/// Reads <bag>-poses-cam0.csv, the poses T_FC0 of Kalibr's camera tool (p_F = q p_C0 + p).
///
/// Its header is wrong about the quaternions (isKalibrPosesHeader()). Numbers have six decimals:
/// orientations are right to about 1e-6 rad. Remarks as readTrajectory()'s, but on gaps: Kalibr
/// keeps the views that tell it most. Throws InputError for what readTrajectory() refuses,
/// and for poses whose optical axes miss the target's plane, or meet it in one place only where the
/// columns are taken as the header names them (a file that somebody put right, or another tool's).
TrajectoryFile readKalibrPoses(const std::string& path);

}  // namespace plumbline
