// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/window/linear_prior.h"

namespace plumbline {

struct CameraWindowOptions : MeasurementModel {
  int size = 10;  ///< frames; who adds more lets the oldest go (full())
  int max_iterations = 50;
  double tolerance = 1e-4;  ///< of the last step, in standard deviations of all parameters

  void check() const;  ///< throws InputError; called by the window
};

/// Of the cameras (poses are not read), in the layout's order.
Displacement displacementOf(const CameraEstimate& to, const CameraEstimate& from);

/// A camera calibration over the last frames and a linear prior that stands for all earlier ones
/// (paper, "real-time estimation"). It minimises
///   0.5 sum rho(|measured - projected|^2) / pixel_sigma^2 + prior(cameras)
/// over the cameras (intrinsics, then T_C0Ci, as in CameraLayout) and T_C0F of the frames held.
/// Given the cameras the frames' poses are independent, so that a frame that leaves is one 6x6
/// Schur complement and the prior is dense on the cameras alone. Its terms are linearised at the
/// estimate at which it leaves, with the loss' weights there (H sums rho' J^T J, b is exact); for
/// what that means for consistency see LinearPrior.
class CameraWindow {
 public:
  /// Starts at the given cameras, of which it takes values but no certainty: nothing is known yet.
  CameraWindow(const AprilGrid& target, const std::vector<CameraCalibration>& cameras,
               const CameraWindowOptions& options = {});

  /// The newest frame; `corners` per camera, ids ascending, empty where it has no view. T_FC0 is
  /// where its solution starts.
  void add(const std::vector<std::vector<Corner>>& corners, const Transform& T_FC0);
  /// Minimises the cost. False, and the estimate stays as it was, where that does not converge.
  [[nodiscard]] bool solve();
  /// Takes frame 0 out and keeps what it says of the cameras as prior. A frame whose own pose is
  /// not determined says nothing.
  void marginaliseOldest();
  /// Takes a frame out with all that it says; 0 is the oldest.
  void remove(int frame);

  int frameCount() const { return static_cast<int>(estimate_.T_C0F.size()); }
  bool full() const { return frameCount() >= options_.size; }
  const CameraEstimate& estimate() const { return estimate_; }
  /// The cameras as they were given, with the values of the estimate.
  std::vector<CameraCalibration> cameras() const;

  /// What the frames that left say, as a cost about other cameras (poses are not read), in their
  /// tangents and the layout's order, in units of pixel_sigma.
  QuadraticCost priorAt(const CameraEstimate& cameras) const { return prior_.at(cameras); }
  /// Of the cameras: prior and frames held, their poses marginalised.
  Eigen::MatrixXd information() const;
  /// sqrt(mean |e|^2) over the corners of the frames held [px]; empty without any.
  std::optional<double> rmsePx() const;

 private:
  CameraProblem problem(std::vector<Frame> frames) const;
  std::vector<Frame> allFrames() const;
  void pack();

  AprilGrid target_;
  std::vector<CameraCalibration> given_;
  CameraWindowOptions options_;
  CameraEstimate estimate_;
  std::vector<std::vector<ImageView>> views_;  // per camera, one per frame
  std::vector<PackedCorners> corners_;         // the same
  LinearPrior<CameraEstimate> prior_;          // its point has no poses
};

}  // namespace plumbline
