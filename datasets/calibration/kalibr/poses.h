// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/trajectory.h"

namespace plumbline {

/// Reads <bag>-poses-cam0.csv, the poses T_FC0 of Kalibr's camera tool (p_F = q p_C0 + p).
///
/// Its header promises q_w, q_x, q_y, q_z; the four numbers are x, y, z, w of the conjugate (JPL)
/// quaternion, so that the Hamilton orientation of columns a, b, c, d is w = d, (x, y, z) =
/// (-a, -b, -c). Numbers have six decimals: orientations are right to about 1e-6 rad.
/// Throws InputError, with file and line, for a file that is not such a table, stamps that do not
/// ascend, numbers that are not finite, quaternions that are not of unit length to 1e-3, and poses
/// whose optical axes miss the target's plane, or meet it in one place only where the columns are
/// taken as the header names them (a file that somebody put right, or another tool's).
Trajectory readKalibrPoses(const std::string& path);

}  // namespace plumbline
