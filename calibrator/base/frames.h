// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"

namespace plumbline {

/// Views of several cameras that were exposed together. view[i] indexes session.cameras[i].views,
/// or is -1 where camera i has no view (or none with corners) in this frame.
struct Frame {
  /// Camera 0's stamp; without a view of camera 0, the stamp of the first camera that has one, less
  /// that camera's stampShifts().
  TimeNs t = 0;
  std::vector<int> view;
};

struct FrameOptions {
  TimeNs tolerance = 2'000'000;  ///< views at most this far apart [ns] may share a frame
  int min_corners = 4;           ///< views with fewer corners are left out

  /// Throws InputError for a negative tolerance or number of corners.
  void check() const;
};

/// Groups the views of all cameras into frames: one-to-one (a view is used once, never twice),
/// nearest stamps first, so that the result does not depend on the order of the cameras' files.
/// Ascending in time; frames in which no camera has a usable view are dropped. Checks the options.
///
/// A camera whose stamps differ from camera 0's by a constant above the tolerance (its nearest
/// stamps spread by less than half of the tolerance about their median, which is at most a quarter
/// of a frame interval) is paired after that constant: it was triggered by the same clock.
std::vector<Frame> pairFrames(const std::vector<CameraStream>& cameras,
                              const FrameOptions& options = {});

/// By how much each camera's stamps are later than camera 0's in the frames that both share: the
/// median [ns]; 0 where they share none.
std::vector<TimeNs> stampShifts(const std::vector<CameraStream>& cameras,
                                const std::vector<Frame>& frames);

}  // namespace plumbline
