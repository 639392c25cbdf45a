// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/error.h"
#include "calibrator/initialise/inertial_alignment.h"
#include "calibrator/initialise/rate_alignment.h"

namespace plumbline {

// Checks of an IMU recording against its stated units, axes and target. Each returns what is wrong
// with the figures that show it, or nothing. They run in this order, each trusting those before.

struct SanityOptions {
  double gravity_m_s2 = MeasurementModel().gravity_m_s2;
  double min_correlation = 0.8;        ///< of gyro and camera rates; EuRoC's is 0.999
  double min_excitation_rad_s = 0.02;  ///< RMS rate below which an axis counts as not turned about
  double rate_tolerance = 0.06;        ///< of the gyroscope's rate against the camera's, relative,
                                       ///< beyond what noise explains
  double scale_tolerance = 0.04;       ///< of the target's size, relative
  double significance = 6;             ///< and in standard deviations
  double gravity_tolerance = 0.03;     ///< of |g| as estimated, relative
  double max_residual_m_s2 = 1.5;      ///< RMS of the inertial alignment
  double noise_floor = 2;  ///< residuals up to this many times their expected RMS are noise

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Samples that are read at once and stamped then: three in ten intervals and more are shorter than
/// a fifth of their mean.
std::optional<Failure> checkSampleStamps(std::span<const ImuSample> samples);

/// Swapped gyro and accelerometer columns, accelerometer in g or milli-g or otherwise scaled: by
/// the median norms of both.
std::optional<Failure> checkSampleUnits(std::span<const ImuSample> samples,
                                        const SanityOptions& options = {});

/// Rotation too small or about one axis only: kNotObservable, with that axis.
std::optional<Failure> checkExcitation(const RateAlignment& alignment,
                                       const SanityOptions& options = {});

/// No correlation of gyro and camera rates, axes of the wrong hand, gyro in degrees per second.
std::optional<Failure> checkRates(const RateAlignment& alignment,
                                  const SanityOptions& options = {});

/// What the inertial alignment leaves over what noise explains; 0: not known.
double residualRatio(const InertialAlignment& alignment);

/// Accelerometer axes that do not fit the gyroscope's, gravity of the wrong size, target of the
/// wrong size. The target is blamed only where what is left is noise with another size and is more
/// than that with the stated one: any fault of the IMU changes the scale as well, but then no scale
/// explains the motion.
std::optional<Failure> checkInertial(const InertialAlignment& alignment, const AprilGrid& target,
                                     const SanityOptions& options = {});

}  // namespace plumbline
