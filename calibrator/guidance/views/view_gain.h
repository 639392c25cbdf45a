// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/batch/camera/problem.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/guidance/views/visible_tags.h"

namespace plumbline {

/// Views that one task of a parallel loop takes; fixed, so that no result depends on the threads.
inline constexpr int kViewChunk = 8;

/// Scores views by their expected information gain: the mutual information with the cameras'
/// parameters g (CameraLayout), given the information I that is there already,
///   gain = 0.5 (log |I + S| - log |I|) [nats],   S = G - P^T H^-1 P,
/// S the information of the view with its own pose marginalised (the paper's mutual information).
/// From one Cholesky factor of [H P; P^T G + I], pose first: the pivots of the pose are those of H,
/// the rest |I + S|. Cost: two of viewGram() and a factor of 28 x 28 for a stereo rig.
class ViewScorer {
 public:
  /// `cameras`: intrinsics and T_C0Ci at which all is linearised (poses are not read);
  /// `information`: I, in the layout's order.
  ViewScorer(const AprilGrid& target, const CameraEstimate& cameras,
             const Eigen::MatrixXd& information, const ViewGainOptions& options = {});

  /// Whether I determines the parameters at all; if not, every gain is infinite.
  bool determined() const { return determined_; }

  /// Corners of the tags that a camera sees when camera 0 is at T_FC0, exact, ids ascending: see
  /// VisibleTags.
  std::vector<Corner> predictedCorners(int camera, const Transform& T_FC0) const;

  /// Gain of a frame that was seen (corners per camera; empty: no view), whose pose is T_FC0, with
  /// the loss' weights [nats].
  double seenGain(const std::vector<std::vector<Corner>>& corners, const Transform& T_FC0) const;

  /// Gains of views that nobody has taken yet [nats]: corners visible in all cameras at each T_FC0,
  /// exact and without loss. NaN where no camera sees enough. The result does not depend on
  /// `threads`.
  std::vector<double> predictedGains(const std::vector<Transform>& T_FC0, int threads = 1) const;

 private:
  class Sum;
  double gainOf(Sum& sum) const;

  AprilGrid target_;
  CameraEstimate cameras_;
  CameraLayout layout_;
  ViewGainOptions options_;
  std::vector<VisibleTags> visible_;  // per camera
  std::vector<Transform> T_CiC0_;
  Eigen::MatrixXd before_;           // sigma^2 [0 0; 0 I], pose first
  double half_log_determinant_ = 0;  // of I
  bool determined_ = false;
};

}  // namespace plumbline
