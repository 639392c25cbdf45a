// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "evaluate/metrics/trajectory/aligned_poses.h"

namespace plumbline {

/// What is measured of a pose's error, with E = R_estimate R_truth^T and d = p_estimate - p_truth,
/// both in the truth's frame.
enum class AbsoluteMeasure {
  kTranslation,         ///< |d| [m]
  kRotationDeg,         ///< angle of E [deg], 0 to 180
  kRotationPart,        ///< |E - I|_F = 2 sqrt(2) sin(angle / 2) (evo's rotation_part)
  kFullTransformation,  ///< sqrt(|E - I|_F^2 + |d|^2): metres and radians mixed (evo)
  kXy,                  ///< horizontal part of |d| [m] (ov_eval's 2d)
  kYawDeg,              ///< z of the rotation vector of E, signed [deg] (ov_eval's 2d)
  kHeadingDeg,          ///< |yaw| of E = Rz(yaw) Ry(pitch) Rx(roll) [deg] (rpg)
};

/// One value for each pair, in their order.
std::vector<double> absoluteErrors(const AlignedPoses& poses, AbsoluteMeasure measure);

}  // namespace plumbline
