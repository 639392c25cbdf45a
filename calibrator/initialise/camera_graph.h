// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// Poses of the target that one camera found by itself: per frame T_CiF, empty where it has none.
using CameraPoses = std::vector<std::optional<Transform>>;

/// Extrinsics T_C0Ci from every camera's own poses (all of one length, frames in the same order).
///
/// Cameras that share frames are joined by the median of T_CiF T_CjF^-1 over these frames; the
/// maximum spanning tree over the number of shared frames leads from camera 0 to every other.
/// Fails with kNoOverlap, naming the cameras (`names`) that share no frame with the rest.
Result<std::vector<Transform>> extrinsicsFromPoses(const std::vector<CameraPoses>& poses,
                                                   const std::vector<std::string>& names);

/// A transform that gross errors in fewer than half of `transforms` do not spoil: medians of the
/// components of translation and of the rotation vector about a common reference. Not empty.
Transform medianTransform(const std::vector<Transform>& transforms);

}  // namespace plumbline
