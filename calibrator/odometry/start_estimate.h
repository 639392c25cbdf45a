// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calibrator/base/results/imu_residuals.h"
#include "calibrator/base/session.h"
#include "calibrator/odometry/rig_model.h"

namespace plumbline {

struct StartOptions {
  double gyro_bias_sigma = 0.05;  ///< of the bias before anything is known [rad/s]
  double accel_bias_sigma = 0.1;  ///< likewise [m/s^2]
  double gravity_sigma = 0.05;    ///< of gravity's magnitude [m/s^2]
  int min_landmarks = 15;         ///< seen three times at least, by any camera
  /// Of v_0, where the rig is known to stand; empty: it may move [m/s].
  std::optional<double> velocity_sigma;
  /// StartEstimate::rms [sigma]. Far above noise: where one camera begins to move, some points are
  /// still on their way to their places, and a start at 6 is good.
  double max_rms = 20;
  double max_velocity_std = 0.25;  ///< of the solved velocity [m/s]
  double max_tilt_std = 0.12;      ///< of gravity's direction [rad]

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A frame of the start: its stamp and what it saw.
struct StartFrame {
  TimeNs t = 0;
  std::vector<std::pair<std::int64_t, Sighting>> seen;  ///< by track id
};

struct StartEstimate {
  std::vector<ImuState> states;  ///< one per frame, in W: the first at the origin, gravity along -z
  /// Of a coordinate of the whitened sightings, from the median of their squares: outliers do not
  /// count.
  double rms = 0;
  double velocity_std = 0;  ///< [m/s], the largest axis
  double tilt_std = 0;      ///< [rad]
};

/// States from a standstill or in motion, without a first guess. Over a second the IMU knows the
/// motion but for v_0, gravity and the biases, in the frame S_0 of the first IMU pose:
///   p_k = v_0 t_k + g t_k^2 / 2 + alpha_k(b),  R_k = R_k(b_gyro),
/// so a sighting of a landmark l, w M R_CS (R_k^T (l - p_k)) + ..., is linear in l, v_0, g; with
/// the biases by Gauss-Newton about zero, under their priors and that of |g|. Landmarks are
/// eliminated one by one; weights 1/|p_C| and Cauchy's come from the step before. Sources: Dong-Si
/// and Mourikis, "Estimator initialization in vision-aided inertial navigation with unknown
/// camera-IMU calibration", IROS 2012; Kaiser et al., "Simultaneous state initialization and
/// gyroscope bias calibration in visual inertial aided navigation", RA-L 2017.
///
/// Empty where the samples do not cover the frames, too few landmarks are seen, the motion does not
/// determine velocity and tilt (one camera without parallax: more frames may), or the sightings do
/// not fit.
std::optional<StartEstimate> startEstimate(std::span<const StartFrame> frames,
                                           std::span<const ImuSample> samples, const RigModel& rig,
                                           const StartOptions& options);

}  // namespace plumbline
