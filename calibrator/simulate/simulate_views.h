// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// Corners of the tags that a camera at T_FC sees, exact, ids ascending; which tags those are says
/// simulateSession(). Empty where the camera is behind the target.
std::vector<Corner> visibleCorners(const Intrinsics& camera, const Transform& T_FC,
                                   const SimulationOptions& options);

/// Where a camera sees a corner of the target [px]; empty where it cannot.
using CornerProjection = std::function<std::optional<Eigen::Vector2d>(int corner_id)>;

/// The same for any way of seeing corners.
std::vector<Corner> visibleCorners(const Resolution& resolution, const CornerProjection& project,
                                   const SimulationOptions& options);

/// Stamps that camera `index` gives its frames: the nominal ones with jitter, less those dropped.
/// Each stamp comes with the frame's number, which selects its random numbers.
struct FrameStamp {
  std::uint64_t frame = 0;
  TimeNs t = 0;
};
std::vector<FrameStamp> simulateStamps(const std::vector<TimeNs>& nominal, int index,
                                       const SimulationOptions& options);

/// Adds noise and outliers to the corners of one camera's frame. Outliers are kept in the image;
/// corners that noise takes out of it are lost.
void disturbCorners(std::vector<Corner>& corners, const Resolution& resolution, int camera,
                    std::uint64_t frame, const SimulationOptions& options);

}  // namespace plumbline
