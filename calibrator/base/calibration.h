// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/camera_models.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// A camera's projection as plain values, in Kalibr's order: `projection` (pinhole: fu fv pu pv
/// [px]) then `distortion` (radtan: k1 k2 p1 p2; equidistant: k1 k2 k3 k4).
struct Intrinsics {
  ProjectionModel projection_model = ProjectionModel::kPinhole;
  DistortionModel distortion_model = DistortionModel::kRadtan;
  Resolution resolution;
  Eigen::VectorXd projection;
  Eigen::VectorXd distortion;

  /// projection and distortion stacked: the order in which parameters are estimated.
  Eigen::VectorXd stacked() const;
  /// Splits a stacked vector back; sizes stay as they are.
  void setStacked(const Eigen::VectorXd& parameters);
};

struct CameraCalibration {
  std::string name;      ///< "cam0", ...
  std::string rostopic;  ///< empty if unknown
  Intrinsics intrinsics;
  Transform T_C0Ci;  ///< this camera in camera 0; identity for camera 0
  std::optional<Eigen::VectorXd> intrinsics_std;  ///< of stacked()
  std::optional<Vector6d> T_C0Ci_std;             ///< 3 m, 3 rad, tangent of Transform
  /// Degrees of freedom of the squares of both, where these were estimated (cluster-robust).
  std::optional<Eigen::VectorXd> intrinsics_dof = {};
  std::optional<Vector6d> T_C0Ci_dof = {};
};

/// t_d of a camera: t_imu = t_cam + t_d.
struct TimeOffset {
  double s = 0;  ///< t_d [s]
  /// Of this camera alone. false: the camera is synchronised with camera 0 and has its offset,
  /// whatever `s` says (camera 0's own flag says nothing).
  bool estimated = false;
};

/// Of every camera, camera 0 first; those behind the last one are synchronised with camera 0.
using TimeOffsets = std::vector<TimeOffset>;

/// Whether camera `c` has an offset of its own beside camera 0's.
inline bool hasOwnOffset(const TimeOffsets& offsets, std::size_t c) {
  return c > 0 && c < offsets.size() && offsets[c].estimated;
}
/// Whether any camera has.
bool haveOwnOffsets(const TimeOffsets& offsets);
/// t_d of camera `c` [s].
inline double offsetOf(const TimeOffsets& offsets, std::size_t c) {
  return offsets[hasOwnOffset(offsets, c) ? c : 0].s;
}

/// Of some of the cameras, the first of which becomes camera 0.
TimeOffsets selected(const TimeOffsets& offsets, const std::vector<std::size_t>& cameras);

struct ImuCalibration {
  Transform T_SC0;  ///< camera 0 in the IMU frame
  TimeOffsets time_offsets{TimeOffset()};
  double gravity_m_s2 = MeasurementModel().gravity_m_s2;
  ImuNoise noise;
  std::string rostopic;
  std::optional<Vector6d> T_SC0_std;        ///< 3 m, 3 rad
  std::optional<double> time_offset_std_s;  ///< of camera 0's
  /// As CameraCalibration::intrinsics_dof.
  std::optional<Vector6d> T_SC0_dof = {};
  std::optional<double> time_offset_dof = {};

  /// t_d of a camera [s].
  double timeOffset(std::size_t camera = 0) const { return offsetOf(time_offsets, camera); }
};

/// What a calibration is to the rest of the world, whichever tool made it.
struct Calibration {
  std::vector<CameraCalibration> cameras;
  std::optional<ImuCalibration> imu;
};

/// A standard deviation that a file states.
struct StatedDeviation {
  double std = 0;  ///< [unit of the parameter]
  /// Of its square; infinite: a formal one, or a robust one without them.
  double dof = std::numeric_limits<double>::infinity();
};
using StatedDeviations = std::map<std::string, StatedDeviation>;  ///< by name of the parameter

/// A covariance with the list of parameters that its rows stand for.
struct ParameterCovariance {
  std::vector<std::string> names;  ///< e.g. "cam0.fu", "T_C0C1.ty", "T_SC0.rx", "time_offset"
  std::vector<std::string> units;  ///< "px", "-", "m", "rad", "s"
  Eigen::MatrixXd matrix;

  Eigen::VectorXd standardDeviations() const { return matrix.diagonal().cwiseSqrt(); }
};

/// Mean of the cameras' time offsets [s]: what a tool with one offset for all compares with
/// (Kalibr estimates one for each camera; ours is one unless the cameras are not synchronised).
double meanTimeOffset(const ImuCalibration& imu);

/// What camera `c` is called in names of parameters: its name or, without one, its place ("cam0").
std::string parameterOwner(const std::vector<CameraCalibration>& cameras, std::size_t c);

/// Names and units of a rig's cameras: all intrinsics ("cam0.fu", by parameterOwner()), then the
/// tangents of all T_C0Ci but the first ("T_C0C1.tx" .. "T_C0C1.rz").
std::vector<ParameterName> cameraParameters(const std::vector<CameraCalibration>& cameras);

/// The tangent of a Transform: "NAME.tx" .. "NAME.tz" [m], "NAME.rx" .. "NAME.rz" [rad].
std::vector<ParameterName> transformParameters(const std::string& name);

/// A list with its covariance; without `matrix` the list alone.
ParameterCovariance parameterCovariance(const std::vector<ParameterName>& parameters,
                                        const Eigen::MatrixXd& matrix = {});

}  // namespace plumbline
