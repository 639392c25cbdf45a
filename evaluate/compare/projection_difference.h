// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/calibration/uncertainty_maps.h"

namespace plumbline {

/// What the fit of the implied alignment minimises, th_j the angle between T_BA p_A and the ray of
/// the same pixel in B, w_j the weights.
enum class DifferenceFit {
  kSquares,      ///< sum w_j th_j^2
  kFourthPower,  ///< sum w_j^2 th_j^4: what mrcal 2.2 computes
};

struct DifferenceOptions {
  double range_m = std::numeric_limits<double>::infinity();  ///< of the points from camera A
  ImageGrid grid;
  /// Only pixels nearer to the image's centre than this take part in the fit [px]. 0: by itself,
  /// min(width, height) / 6 without weights (mrcal's choice), the whole image with weights.
  double focus_radius_px = 0;
  std::vector<double> weights;  ///< one per grid point; empty: all alike; not finite: left out
  DifferenceFit fit = DifferenceFit::kSquares;
};

/// Rays that a fit needs.
inline constexpr int kFewestFitRays = 3;

/// Grid points that are near enough to the image's centre to take part in the fit.
int pointsInFocus(const Resolution& image, const DifferenceOptions& options);

struct ProjectionDifference {
  Transform T_BA;                        ///< implied: A's points in B's frame
  std::vector<Eigen::Vector2d> vectors;  ///< q_B - q_A [px], one per grid point; NaN: undefined
  int fitted = 0;                        ///< grid points in the fit
};

/// How differently two calibrations A and B of one camera see the world, as mrcal's
/// projection_diff(): every grid pixel q_A is unprojected with A, placed at the range, moved by
/// T_BA and projected with B.
///
/// A camera's frame is tied to its housing only by its intrinsics, so that two calibrations differ
/// by a rigid motion that is no disagreement; T_BA is fitted to take it out. At infinity it is a
/// rotation, at a finite range a full transform. At infinity with kSquares, T_AB is T_BA^-1 to
/// rounding, and the vectors change their sign to first order in their size.
/// Any pair of models; both images must have the same size (InputError). Empty where fewer than
/// kFewestFitRays rays of the focus region are defined in both.
std::optional<ProjectionDifference> projectionDifference(const Intrinsics& A, const Intrinsics& B,
                                                         const DifferenceOptions& options = {});

}  // namespace plumbline
