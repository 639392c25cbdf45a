// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "calibrator/base/session.h"

namespace plumbline {

/// What every estimation assumes of its measurements: the one home of these defaults. Options of
/// stages, windows and guides begin with it, and pass it on whole.
struct MeasurementModel {
  double pixel_sigma = 1;         ///< standard deviation of a corner, per axis [px]
  double cauchy_px = 3;           ///< scale of the Cauchy loss on |e| [px]; 0: squared error
  double gravity_m_s2 = 9.80655;  ///< magnitude of gravity; its direction is estimated
  std::optional<ImuNoise> noise;  ///< in place of the session's densities

  MeasurementModel& model() { return *this; }
  const MeasurementModel& model() const { return *this; }

  /// Throws InputError unless sigma, gravity and densities are positive, and the loss is 0 or at
  /// least 1e-3 px.
  void check() const;
};

}  // namespace plumbline
