// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// A point in the camera's frame and where the image shows it.
struct SeenPoint {
  Eigen::Vector3d p_C;  ///< [m], or a direction of any length
  Eigen::Vector2d uv;   ///< [px]
};

struct LensFit {
  Intrinsics lens;
  double rms_px = 0;   ///< sqrt(mean |error|^2) over the points that count
  double most_px = 0;  ///< the largest error among them
  int points = 0;      ///< that the model can project
};

/// The intrinsics of `start`'s model that bring the points closest to where they are seen:
///   minimise sum |project(k, p_C) - uv|^2 over k,
/// by Levenberg and Marquardt from `start`, in 200 steps at most. Points that `start` cannot
/// project at all (behind a pinhole, say) are left out and not counted. Empty where the points
/// left, two equations each, are too few for the parameters.
std::optional<LensFit> fitLens(const Intrinsics& start, const std::vector<SeenPoint>& points);

/// A lens of another model without its shape: with the magnification of `lens` at its centre, and
/// its principal point (plainCamera()).
Intrinsics plainLike(const Intrinsics& lens, ProjectionModel projection,
                     DistortionModel distortion);

/// A lens in another model: the least projection error over the pixels of the image, taken on a
/// grid of `columns` x `rows`, the camera's orientation kept. Pixels without a ray take no part.
/// Empty as with fitLens().
std::optional<LensFit> convertedLens(const Intrinsics& from, ProjectionModel projection,
                                     DistortionModel distortion, int columns = 48, int rows = 32);

}  // namespace plumbline
