// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "calibrator/odometry/odometry.h"

namespace plumbline {

/// A time offset as the odometry would choose it.
struct OffsetHint {
  double change_s = 0;  ///< to the one that was used
  double std_s = 0;
};

/// Innovations of a run whose time offset is changed by so much.
using InnovationsAt = std::function<std::vector<FrameInnovation>(double change_s)>;

/// The change of the time offset under which the IMU predicts the tracks best: the minimum of a
/// parabola through the mean squared innovations J(0), J(+-h), J(+-2h) around it, h = 3 ms, over
/// the frames that all five runs predicted; moved to the minimum and done again (at most three
/// times) where that lies beyond h. The deviation is the jackknife's over blocks of a second, as
/// the innovations of one frame err together. A hint and no calibration: wrong extrinsics move it,
/// too. Empty where the innovations have no minimum within 20 ms, or there are fewer than 8 blocks.
std::optional<OffsetHint> offsetHint(const InnovationsAt& run);

}  // namespace plumbline
