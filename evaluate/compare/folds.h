// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/frames.h"
#include "calibrator/base/session.h"

namespace plumbline {

/// A session parted into what is calibrated on and what that is scored on.
struct Fold {
  Session training;
  Session held_out;
};

/// Fold `index` of `count`: the frames (see pairFrames()) in `count` runs of consecutive ones whose
/// numbers differ by one at most; run `index` is held out, the others are for training. Neighbours
/// in time resemble each other, so that scattered frames would not be held out in earnest. Views
/// that no frame takes are in neither part; IMU samples are in both, since only corners are scored.
/// 0 <= index < count, 2 <= count.
Fold foldOf(const Session& session, const FrameOptions& options, int index, int count);

/// How many frames the session has.
int frameCount(const Session& session, const FrameOptions& options);

}  // namespace plumbline
