// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/guidance/views/tag_kernel.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {

/// Which tags of a target a camera sees: those with all four corners inside the image by a border
/// and inside the camera model's domain, and no side shorter than a limit; the same as simulated
/// recordings have (calibrator/simulate/simulate_session.h), made for many views of one camera.
/// What depends on the intrinsics alone (the radius at which the distortion folds) is found once.
class VisibleTags {
 public:
  struct Limits {
    double border_px = 5;   ///< tags that come closer to the image's border are not seen
    double min_tag_px = 8;  ///< nor are tags with a side shorter than this
  };
  VisibleTags(const Intrinsics& camera, const AprilGrid& target, const Limits& limits);

  int cornerCount() const { return static_cast<int>(x_.size()); }
  /// Their corners for the target at T_CF, exact, ids ascending. None from behind the target.
  void predict(const Transform& T_CF, PredictedCorners& into) const {
    predictWith(bestInstructionSet(), T_CF, into);
  }
  /// The same as corners.
  std::vector<Corner> corners(const Transform& T_CF) const;
  /// With the version chosen by the caller (tests); all agree to rounding.
  void predictWith(InstructionSet set, const Transform& T_CF, PredictedCorners& into) const;

 private:
  std::vector<double> x_, y_, z_;  // of the corners by id, in F [m]
  AnyCameraModel model_;
  tags::Bounds bounds_;
};

}  // namespace plumbline
