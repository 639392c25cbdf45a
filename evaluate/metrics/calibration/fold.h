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

/// Which part of a session is held out: 0 <= index < count, 2 <= count.
struct FoldChoice {
  int index = 0;
  int count = 2;
  double time_offset_s = 0;  ///< t_imu = t_cam + this, to cut the IMU's samples by
};

/// Fold `index` of `count`: the frames (see pairFrames()) in `count` runs of consecutive ones whose
/// numbers differ by one at most; run `index` is held out, the others are for training. Neighbours
/// in time resemble each other, so that scattered frames would not be held out in earnest. Views
/// that no frame takes are in neither part. IMU samples between the first and the last frame that
/// is held out are not for training: its chain of states breaks there. The held-out part keeps all
/// samples, of which only those between its own frames enter.
Fold foldOf(const Session& session, const FrameOptions& options, const FoldChoice& choice);

}  // namespace plumbline
