// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/simulation_options.h"

#include <cmath>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

void requireTarget(const AprilGrid& target) {
  requireWithin(1, 1000, "target.rows", target.rows);
  requireWithin(1, 1000, "target.cols", target.cols);
  requireWithin(1e-6, 100, "target.tag_size", target.tag_size);
  requireWithin(0, 10, "target.spacing", target.spacing);
}

}  // namespace

void SimulationOptions::check() const {
  requireTarget(target);
  requireWithin(1e-3, 1e5, "simulation.duration_s", duration_s);
  requireWithin(1e-3, 1e5, "simulation.camera_rate_hz", camera_rate_hz.value_or(1));
  requireWithin(1e-3, 1e5, "simulation.imu_rate_hz", imu_rate_hz.value_or(1));
  requireWithin(-1e3, 1e3, "simulation.time_offset_s", time_offset_s.value_or(0));
  requireWithin(-0.4 * duration_s, 1e3, "simulation.imu_margin_s", imu_margin_s);
  requireWithin(0, 1e3, "simulation.corner_sigma_px", corner_sigma_px);
  requireWithin(0, 1, "simulation.outlier_fraction", outlier_fraction);
  requireWithin(0, 1e4, "simulation.outlier_px", outlier_px);
  requireWithin(0, 1, "simulation.dropped_fraction", dropped_fraction);
  requireWithin(0, 10, "simulation.stamp_jitter_s", stamp_jitter_s);
  requireWithin(0, 1e4, "simulation.border_px", border_px);
  requireWithin(0, 1e4, "simulation.min_tag_px", min_tag_px);
  requireWithin(1e-6, 1e6, "|down_F|", down_F.norm());
  // Along x of F, T_WF() would have no x axis to start from.
  requireWithin(0, 0.999999, "|down_F.x| / |down_F|", std::abs(down_F.x()) / down_F.norm());
  requireWithin(1e-6, 100, "trajectory.pace", trajectory.pace);
  requireWithin(0.1, 100, "trajectory.distance_ratio", trajectory.distance_ratio);
  requireWithin(1e-6, 1e6, "|trajectory.axis_S|", trajectory.axis_S.norm());
}

}  // namespace plumbline
