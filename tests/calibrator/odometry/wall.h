// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/image.h"
#include "calibrator/odometry/rig_model.h"

namespace plumbline::test {

/// A wall that fills the view, with a smooth pattern that is nowhere the same: z = 2 m in W.
inline constexpr double kWall_m = 2;

/// Two pinholes of 240 x 180 pixels side by side, 0.1 m apart, on an IMU whose axes lie otherwise.
RigModel wallRig();

/// Where the ray of a pixel meets the wall (x, y in W).
Eigen::Vector2d onWall(const RigModel& rig, const Transform& T_WC0, int camera,
                       const Eigen::Vector2d& uv);

/// The wall as a camera shows it, camera 0 being at T_WC0.
GrayImage seenFrom(const RigModel& rig, const Transform& T_WC0, int camera);

}  // namespace plumbline::test
