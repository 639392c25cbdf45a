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

/// Which views of each camera some frames take: `wanted` are positions in `frames`, which
/// pairFrames() made of the session.
using ViewChoice = std::vector<std::vector<bool>>;
ViewChoice viewsOf(const Session& session, const std::vector<Frame>& frames,
                   const std::vector<int>& wanted);

/// The items that are chosen, in their order.
template <class Item>
std::vector<Item> chosen(const std::vector<Item>& items, const std::vector<bool>& choice) {
  std::vector<Item> out;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (choice[i]) out.push_back(items[i]);
  }
  return out;
}

/// The session with its target, cameras and IMU samples, but without views.
Session withoutViews(Session session);

/// The session with the views of some of its frames. All IMU samples stay.
Session withFrames(const Session& session, const std::vector<Frame>& frames,
                   const std::vector<int>& wanted);

/// By how much each camera's stamps are later than camera 0's in the frames that both share: the
/// median [ns]; 0 where they share none.
std::vector<TimeNs> stampShifts(const std::vector<CameraStream>& cameras,
                                const std::vector<Frame>& frames);

}  // namespace plumbline
