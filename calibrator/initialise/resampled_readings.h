// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "calibrator/base/session.h"

namespace plumbline {

/// What a driver has made of readings at a lower rate: shares of the readings of one sensor.
struct Resampling {
  double held = 0;     ///< repeat a neighbour in all three axes although the motion goes on
  double on_line = 0;  ///< lie on the straight line between their neighbours, in time
};

/// Of readings x_k whose neighbours differ by the median of |x_k+1 - x_k-1| or more: those equal to
/// a neighbour, and those with |e_k| below 0.02 of the 90 % quantile of |e|, e_k the distance from
/// the line between the neighbours. A raw stream has noise of its own in every reading: of EuRoC's
/// recordings 0.2 % at most are either. Nothing is said (both 0) of fewer than 200 readings, or of
/// a converter whose step is a fifth of that median or more.
Resampling findResampling(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*sensor);

}  // namespace plumbline
