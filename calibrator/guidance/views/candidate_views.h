// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// Which views are candidates for the next best one, all of them looking at the target's centre.
struct CandidateViewOptions {
  /// Frontal: `grid` x `grid` camera positions at one depth, within +-reach of half the target's
  /// width and height around its centre.
  int grid = 6;
  double reach = 1.6;
  /// The depth is the one at which half the target's longer side fills this share of half the
  /// image's width, times each of `depths`; at the first of them the whole grid, at the others
  /// 3 x 3.
  double fill = 0.8;
  std::vector<double> depths = {1, 0.75, 1.4};
  /// Tilted: the camera goes round the centre by each angle both ways about x and about y of F, at
  /// each depth; below 90 degrees.
  std::vector<double> tilts_deg = {30, 45};
  /// The tilted views at the first depth, and the central one at every depth, also turned about the
  /// line of sight.
  std::vector<double> rolls_deg = {45, 90};

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A view that could be asked for.
struct CandidateView {
  /// "cam0 x -0.53 y +1.07", "cam1 tilt-x -30 depth 0.75", "cam0 tilt-y +45 roll 90": x and y in
  /// halves of the target's width and height, the depth where it is not the first, degrees.
  std::string name;
  int camera = 0;   ///< for whose image it was made
  Transform T_FC0;  ///< where camera 0 is then
};

/// Candidates for all cameras, in camera order; with the default options 100 per camera. Camera i
/// stands at T_FCi, so that T_FC0 = T_FCi T_C0Ci^-1. The depth is taken from the projection (the
/// ray of a pixel), so that fisheyes are served as well; rays beyond 60 degrees count as 60, where
/// a plane target cannot come nearer and still be seen. Sources: grid, reach and fill are those of
/// the paper's public code (yac); the tilt is added since studies of calibration motions find it to
/// matter most (mrcal.secretsauce.net/tour-choreography.html).
std::vector<CandidateView> candidateViews(const std::vector<CameraCalibration>& cameras,
                                          const AprilGrid& target,
                                          const CandidateViewOptions& options = {});

/// Of the candidates of camera 0 those to begin with, before any can be scored: near, and tilted by
/// 45 degrees to each side (measured: docs/counterfactuals.md).
std::vector<CandidateView> firstViews(const CameraCalibration& camera, const AprilGrid& target);

}  // namespace plumbline
