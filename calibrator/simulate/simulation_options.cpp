// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/simulation_options.h"

#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

/// `value` must lie in [low, high]; written so that NaN fails.
void requireWithin(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw InputError(fmt::format("simulation option {} is {}; expected a value from {} to {}", name,
                                 value, low, high));
  }
}

void requireTarget(const AprilGrid& target) {
  requireWithin("target.rows", target.rows, 1, 1000);
  requireWithin("target.cols", target.cols, 1, 1000);
  requireWithin("target.tag_size", target.tag_size, 1e-6, 100);
  requireWithin("target.spacing", target.spacing, 0, 10);
}

}  // namespace

void check(const SimulationOptions& o) {
  requireTarget(o.target);
  requireWithin("duration_s", o.duration_s, 1e-3, 1e5);
  requireWithin("camera_rate_hz", o.camera_rate_hz.value_or(1), 1e-3, 1e5);
  requireWithin("imu_rate_hz", o.imu_rate_hz.value_or(1), 1e-3, 1e5);
  requireWithin("time_offset_s", o.time_offset_s.value_or(0), -1e3, 1e3);
  requireWithin("imu_margin_s", o.imu_margin_s, -0.4 * o.duration_s, 1e3);
  requireWithin("corner_sigma_px", o.corner_sigma_px, 0, 1e3);
  requireWithin("outlier_fraction", o.outlier_fraction, 0, 1);
  requireWithin("outlier_px", o.outlier_px, 0, 1e4);
  requireWithin("dropped_fraction", o.dropped_fraction, 0, 1);
  requireWithin("stamp_jitter_s", o.stamp_jitter_s, 0, 10);
  requireWithin("border_px", o.border_px, 0, 1e4);
  requireWithin("min_tag_px", o.min_tag_px, 0, 1e4);
  requireWithin("|down_F|", o.down_F.norm(), 1e-6, 1e6);
  // Along x of F, T_WF() would have no x axis to start from.
  requireWithin("|down_F.x| / |down_F|", std::abs(o.down_F.x()) / o.down_F.norm(), 0, 0.999999);
  requireWithin("trajectory.pace", o.trajectory.pace, 1e-6, 100);
  requireWithin("trajectory.distance_ratio", o.trajectory.distance_ratio, 0.1, 100);
  requireWithin("|trajectory.axis_S|", o.trajectory.axis_S.norm(), 1e-6, 1e6);
}

}  // namespace plumbline
