// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"

namespace plumbline {

/// Views of several cameras that were exposed together. view[i] indexes session.cameras[i].views,
/// or is -1 where camera i has no view (or none with corners) in this frame.
struct Frame {
  TimeNs t = 0;  ///< mean of the stamps of its views
  std::vector<int> view;
};

struct FrameOptions {
  TimeNs tolerance = 2'000'000;  ///< views at most this far apart [ns] may share a frame
  int min_corners = 4;           ///< views with fewer corners are left out
};

/// Groups the views of all cameras into frames: one-to-one (a view is used once, never twice),
/// nearest stamps first, so that the result does not depend on the order of the cameras' files.
/// Ascending in time; frames in which no camera has a usable view are dropped.
std::vector<Frame> pairFrames(const std::vector<CameraStream>& cameras,
                              const FrameOptions& options = {});

}  // namespace plumbline
