// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "calibrator/base/session.h"

namespace plumbline {

/// What readings at a lower rate have become: shares of the readings of one sensor.
struct Resampling {
  double held = 0;     ///< repeat a neighbour in all three axes although the motion goes on
  double on_line = 0;  ///< lie on the straight line between their neighbours, in time
};

/// Of readings x_k whose neighbours differ by the median of |x_k+1 - x_k-1| (of those that are not
/// 0) or more: those equal to a neighbour, and those with |e_k| below 0.01 of the 99 % quantile of
/// |e|, e_k the distance from the line between the neighbours. A raw stream has noise of its own in
/// every reading: of EuRoC's recordings 0.2 % at most are either. Of readings interpolated from an
/// r-th of the rate a share of about 1 - 2 / r has both neighbours on its line, 1 - 1 / r where
/// every r-th stamp is an original one: below r = 2.5 they may not be told. Empty for fewer than
/// 200 readings, and for a converter whose step is a fifth of that median or more.
std::optional<Resampling> findResampling(std::span<const ImuSample> samples,
                                         Eigen::Vector3d ImuSample::*sensor);

}  // namespace plumbline
