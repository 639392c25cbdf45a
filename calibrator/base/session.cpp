// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/session.h"

#include "calibrator/base/option_check.h"

namespace plumbline {

void MeasurementModel::check() const {
  requirePositive("pixel_sigma", pixel_sigma);
  requirePositive("gravity_m_s2", gravity_m_s2);
  // 0 is squared error; a scale far below any detector's noise would leave no corner a weight.
  if (cauchy_px != 0) requireAtLeast(1e-3, "cauchy_px", cauchy_px);
  if (!noise) return;
  requirePositive("noise.gyro_density", noise->gyro_density);
  requirePositive("noise.gyro_random_walk", noise->gyro_random_walk);
  requirePositive("noise.accel_density", noise->accel_density);
  requirePositive("noise.accel_random_walk", noise->accel_random_walk);
}

}  // namespace plumbline
