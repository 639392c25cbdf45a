// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/rig_model.h"

#include <algorithm>

#include "calibrator/base/error.h"
#include "calibrator/camera/camera.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {

RigModel RigModel::of(const Calibration& calibration, int cameras) {
  if (!calibration.imu) throw InputError("the calibration has no IMU; odometry needs T_SC0");
  if (calibration.cameras.empty()) throw InputError("the calibration has no camera");
  // A weight is the inverse of a density.
  const ImuNoise& n = calibration.imu->noise;
  const bool positive = n.gyro_density > 0 && n.gyro_random_walk > 0 && n.accel_density > 0 &&
                        n.accel_random_walk > 0;
  if (!positive) {
    throw InputError(
        "a noise density of the calibration's IMU is not positive; odometry needs all four; "
        "correct the calibration, or give Kalibr's imu.yaml in addition");
  }
  RigModel rig;
  const auto all = static_cast<int>(calibration.cameras.size());
  const int used = cameras > 0 ? std::min(cameras, all) : all;
  for (int c = 0; c < used; ++c) {
    const CameraCalibration& camera = calibration.cameras[c];
    rig.cameras.push_back(camera.intrinsics);
    rig.T_SC.push_back(calibration.imu->T_SC0 * camera.T_C0Ci);
  }
  rig.noise = n;
  rig.time_offset_s = calibration.imu->timeOffset();
  rig.gravity_m_s2 = calibration.imu->gravity_m_s2;
  return rig;
}

std::optional<Sighting> RigModel::sighting(int camera, const Eigen::Vector2d& uv,
                                           double sigma_px) const {
  const Intrinsics& intrinsics = cameras[camera];
  const auto f = unproject(intrinsics, uv);
  if (!f) return std::nullopt;
  const auto projected = projectWithJacobians(intrinsics, *f);
  if (!projected) return std::nullopt;
  // With |f| = 1, B spans the derivatives of p / |p|.
  const Eigen::Matrix<double, 3, 2> B = tangentBasis(*f);
  Sighting s;
  s.camera = camera;
  s.f = *f;
  s.M = (projected->J_point * B) * B.transpose() / sigma_px;
  return s;
}

}  // namespace plumbline
