// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Corners that a camera would see, in memory that the next view uses again.
class PredictedCorners {
 public:
  explicit PredictedCorners(int most);
  void clear() { count_ = 0; }
  /// A corner at (x, y) of F [m], seen at (u, v) [px].
  void add(int id, double x, double y, double u, double v);
  /// All that was added, each with weight 1; valid until the next change.
  PackedView view();

 private:
  int stride_;
  int count_ = 0;
  std::vector<double> columns_;  // x y u v w
  std::vector<int> ids_;
};

/// Which tags of a target a camera sees: those with all four corners inside the image by a border
/// and inside the camera model's domain, and no side shorter than a limit; the same as simulated
/// recordings have (calibrator/simulate/simulate_views.h), made for many views of one camera.
class VisibleTags {
 public:
  struct Limits {
    double border_px = 5;
    double min_tag_px = 8;
  };
  VisibleTags(const Intrinsics& camera, const AprilGrid& target, const Limits& limits);

  int cornerCount() const { return static_cast<int>(x_.size()); }
  /// Their corners for the target at T_CF, exact, ids ascending. None from behind the target.
  void predict(const Transform& T_CF, PredictedCorners& into) const;

 private:
  template <class Model>
  void predictAs(Model model, const Transform& T_CF, PredictedCorners& into) const;

  std::vector<double> x_, y_;  // of the corners by id, in F [m]
  AnyCameraModel model_;
  CameraValues lens_;
  double squared_radius_limit_;  // of X/Z, Y/Z, where a pinhole's distortion folds
  double border_px_, squared_side_;
  double right_px_, bottom_px_;
};

}  // namespace plumbline
