// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {

/// Corners of one frame, per camera; ids ascending; empty where a camera has no view.
using FrameCorners = std::vector<std::vector<Corner>>;

/// The views of a frame that hold at least so many corners; the others are empty.
FrameCorners usableViews(const GuideFrame& frame, std::size_t cameras, int min_corners);

/// No camera has a view.
bool seesNothing(const FrameCorners& corners);

/// Whether some camera's view moved by more than `least_px` (mean corner distance), or shows other
/// parts of the target, or is there when it was not before.
bool hasMoved(const FrameCorners& before, const FrameCorners& now, double least_px);

/// Mean distance of the corners that both lists hold [px]; ids ascending. Empty where fewer than
/// four are in both.
std::optional<double> meanCornerDistance(const std::vector<Corner>& a,
                                         const std::vector<Corner>& b);

/// A frame's corners as poses and information are found from them.
struct PackedFrame {
  std::vector<PackedCorners> corners;  ///< per camera, also of one without corners

  PackedFrame() = default;
  PackedFrame(const AprilGrid& target, const FrameCorners& seen);
  /// Of the cameras that have corners. The estimate and this frame must outlive them.
  std::vector<FrameView> views(const CameraEstimate& cameras) const;
};

/// T_FC0 from one frame's corners at known cameras, from nothing; empty where what remains is more
/// than 1.5 % of the image's width.
std::optional<Transform> poseOf(const AprilGrid& target, const CameraEstimate& cameras,
                                const FrameCorners& corners, double cauchy_px);

/// A frame that a stage has accepted.
struct KeptFrame {
  int index = 0;  ///< position in the recording
  TimeNs t = 0;
  FrameCorners corners;
};

/// What the cameras of a rig saw in frames that were kept. Views of a frame keep its stamp, by
/// which the batch pairs them again.
template <class Kept>
Session sessionOf(const GuideRig& rig, const std::vector<Kept>& frames) {
  Session session;
  session.target = rig.target;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    CameraStream& stream = session.cameras.emplace_back();
    stream.name = rig.cameras[c].name;
    stream.resolution = rig.cameras[c].resolution;
    for (const Kept& frame : frames) {
      if (!frame.corners[c].empty()) stream.views.push_back({frame.t, frame.corners[c]});
    }
  }
  return session;
}

}  // namespace plumbline
