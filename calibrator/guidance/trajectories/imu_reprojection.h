// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"

namespace plumbline {

using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// How camera and IMU are used together later: points at these distances, all over the images,
/// looked for where the IMU's motion puts them. Motions have every direction alike.
struct ImuUse {
  std::array<double, 3> ranges_m{1, 3, 10};
  double speed_m_s = 1;       ///< RMS of the sensor's velocity
  double rate_rad_s = 1;      ///< RMS of its rate
  int columns = 9, rows = 7;  ///< grid of pixels over each image
};

/// By how much errors of T_SC0 and of the time offset shift the points that the IMU predicts.
///
/// At the stamp t of a frame the IMU says where the sensor was at t + t_d, and T_SC0 where the
/// camera was. With errors d of T_SC0 (tangent of Transform) and e of t_d a point fixed in the
/// world is looked for at the twist
///   x = A d - e B (v, omega),   p' = p + x_rho + x_phi x p   (camera frame),
/// A as in cameraImuChain(), B the adjoint of T_CiS, v and omega the sensor's velocity and rate in
/// its own frame. The mean square of the shift of the pixel over points, cameras and motions is
///   (d, e)^T M (d, e),   M = mean J^T J   [px^2 per (m, rad, s) squared],
/// in which d and e do not mix, for motions of opposite direction are as frequent. With the
/// covariance S of (d, e) the expected squared error is E = tr(M S) [px^2].
class ImuReprojection {
 public:
  /// Pixels that the models cannot unproject are left out.
  explicit ImuReprojection(const std::vector<CameraCalibration>& cameras, const ImuUse& use = {});

  /// M at this T_SC0: rows and columns T_SC0 (3 m, 3 rad), time offset (s).
  Matrix7d gram(const Transform& T_SC0) const;
  /// E [px^2] from the information of T_SC0 and time offset (7 x 7); empty where that is singular.
  std::optional<double> expectedError(const Eigen::MatrixXd& information,
                                      const Transform& T_SC0) const;
  /// E [px^2] from their covariance (7 x 7).
  double expectedErrorUnder(const Eigen::MatrixXd& covariance, const Transform& T_SC0) const;
  /// By how much points are off with `a` from where `b` puts them: sqrt((d, e)^T M (d, e)) [px].
  double differencePx(const ImuCalibration& a, const ImuCalibration& b) const;

 private:
  struct Camera {
    Transform T_C0Ci;
    Matrix6d H;  // mean of J^T J over points, J the pixel's derivative by the twist
  };
  ImuUse use_;
  std::vector<Camera> cameras_;
};

}  // namespace plumbline
