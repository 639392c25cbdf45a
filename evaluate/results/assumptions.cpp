// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/results/assumptions.h"

#include <fmt/format.h>

namespace plumbline {

Assumptions assumptionsOf(const CameraStageOptions& camera, const CameraImuOptions& camera_imu) {
  Assumptions assumptions;
  assumptions.pixel_sigma_px = camera.pixel_sigma;
  assumptions.gravity_m_s2 = camera_imu.gravity_m_s2;
  if (camera.cauchy_px > 0) assumptions.loss = fmt::format("cauchy:{}", camera.cauchy_px);
  return assumptions;
}

Assumptions assumptionsOf(const CameraStageOptions& camera, const CameraImuOptions& camera_imu,
                          const Session& session) {
  Assumptions assumptions = assumptionsOf(camera, camera_imu);
  if (session.imu) assumptions.imu_noise = session.imu->noise;
  return assumptions;
}

}  // namespace plumbline
