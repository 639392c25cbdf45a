// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "calibrator/base/time.h"

namespace plumbline {

/// A fault of the recording or of its description that the camera-IMU batch does not model, with
/// what its estimate lists.
enum class UnmodelledFault {
  kAccelScale,         ///< scale errors of the accelerometer's axes, 3 [1]
  kAccelMisalignment,  ///< off-diagonal terms of its matrix, row by row, 6 [rad]
  kGyroScale,          ///< 3 [1]
  kGyroMisalignment,   ///< 6 [rad]
  kGSensitivity,       ///< of the gyroscope, 3 x 3 row by row [rad/s per m/s^2]
  kImuDelay,           ///< by how much the accelerometer is later than the gyroscope [s]
  kClockDrift,         ///< growth of the time offset [s/s]
  kLineDelay,          ///< readout time of the image's height (rolling shutter), of one camera or
                       ///< one for all [s]
  kTargetSize,         ///< the target is larger than stated, relative [1]
  kCameraDelay,        ///< by how much a camera's time offset differs from camera 0's [s]
  kImuMoved,           ///< change of T_SC0 from an instant on (3 m, 3 rad)
  kClockStep,          ///< change of the time offset from an instant on [s]
  kCameraMoved,        ///< change of T_C0Ci from an instant on (3 m, 3 rad)
  kTargetShape,   ///< the target is not flat or not even, all terms of TargetBasis but tag_edge [m]
  kTargetMoved,   ///< displacement of the target in F at an instant, 3 [m]
  kTargetSways,   ///< target swinging in F, sine x y z and cosine x y z [m]
  kGyroBiasJump,  ///< jump of the gyroscope's bias at an instant, 3 [rad/s]
  kAccelBiasJump,  ///< jump of the accelerometer's bias at an instant, 3 [m/s^2]
  kStampsWander,   ///< changes of the time offset at seven instants, evenly spaced [s]
  kGivenCameras,   ///< cameras that were given, in the order of their own stage: all intrinsics,
                   ///< then all T_C0Ci but camera 0's
  kSoftMount,      ///< change of T_SC0 (3 m, 3 rad) per m/s^2 of specific force along x of the
                   ///< IMU, then along y, then along z
  kColumnDelay,    ///< readout time of the image's width, of all cameras: a rolling shutter whose
                   ///< camera is mounted on its side [s]
};

/// Words of the documents, in the order above.
inline constexpr std::array<const char*, 22> enumWords(UnmodelledFault) {
  return {"accel-scale",    "accel-misalignment", "gyro-scale",    "gyro-misalignment",
          "g-sensitivity",  "imu-delay",          "clock-drift",   "line-delay",
          "target-size",    "camera-delay",       "imu-moved",     "clock-step",
          "camera-moved",   "target-shape",       "target-moved",  "target-sways",
          "gyro-bias-jump", "accel-bias-jump",    "stamps-wander", "given-cameras",
          "soft-mount",     "column-delay"};
}

/// A score test: is the fault there, how large is it, and what does it do to the calibration?
struct FaultTest {
  UnmodelledFault fault = UnmodelledFault::kAccelScale;
  int camera = -1;              ///< of faults that one camera has; -1: of the recording
  std::optional<TimeNs> since;  ///< of faults that begin at an instant, where they explain most
  Eigen::VectorXd estimate;     ///< to first order, see UnmodelledFault
  Eigen::VectorXd std;          ///< cluster-robust; NaN: the motion does not determine it
  std::optional<double> frequency_hz;  ///< of what swings
  double chi2 = 0;                     ///< of the estimate against zero, see diagnoseFaults()
  double explained = 0;  ///< by how much twice the batch's cost falls with the fault in the model,
                         ///< over the factor by which robust variances exceed formal ones
  int dof = 0;
  double significance = 0;  ///< of chi2, in standard deviations (Wilson and Hilferty)
  /// What modelling the fault would add to T_SC0 (3 m, 3 rad) and the time offset [s].
  Eigen::Matrix<double, 7, 1> shift = Eigen::Matrix<double, 7, 1>::Zero();
  double shift_sigma = 0;  ///< the largest of them in its robust standard deviation
};

struct FaultDiagnosis {
  std::vector<FaultTest> tests;  ///< each fault alone beside the calibration's own parameters
  /// Those that explain the residuals, most important first, each tested with those before it in
  /// the model. Empty: none is significant.
  std::vector<FaultTest> causes;
  /// One that explains the residuals as well as the first cause, so that the two cannot be told
  /// apart from this recording.
  std::optional<FaultTest> alternative;
  /// Cluster-robust standard deviations of T_SC0 (3 m, 3 rad) and the time offset [s], and the
  /// formal ones under the same assumptions.
  Eigen::Matrix<double, 7, 1> robust_std = Eigen::Matrix<double, 7, 1>::Zero();
  Eigen::Matrix<double, 7, 1> formal_std = Eigen::Matrix<double, 7, 1>::Zero();
  std::optional<Eigen::VectorXd> robust_dof;  ///< degrees of freedom of the squares of `robust_std`
  /// How T_SC0 and the offset follow the cameras that the batch holds, to first order: 7 rows, and
  /// columns for all intrinsics, all T_C0Ci and the board's terms but tag_edge, each as its stage's
  /// covariance lists it. Empty where the cameras are free.
  Eigen::MatrixXd by_cameras;
};

}  // namespace plumbline
