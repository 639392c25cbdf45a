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

/// Whether a pinhole can be asked to show this point: less than 88 degrees off the axis. Its plane
/// coordinates grow without bound towards 90.
bool isWellAhead(const Eigen::Vector3d& p_C);

/// The intrinsics of `start`'s model that bring the points closest to where they are seen:
///   minimise sum |project(k, p_C) - uv|^2 over k,
/// by Levenberg and Marquardt from `start`, in 200 steps at most; whether it converged by then is
/// not told. Points that `start` cannot project at all, and for a pinhole those that are not
/// isWellAhead(), are left out and not counted. Empty where the points left, two equations each,
/// are too few for the parameters.
std::optional<LensFit> fitLens(const Intrinsics& start, const std::vector<SeenPoint>& points);

/// A lens of another model without its shape: with the magnification of `lens` at its centre, and
/// its principal point (plainCamera()).
Intrinsics plainLike(const Intrinsics& lens, ProjectionModel projection,
                     DistortionModel distortion);

/// A lens in another model: the least projection error over the pixels of the image, taken on a
/// grid of `columns` x `rows` (two and more) from its first pixels to its last, the camera's
/// orientation kept. Pixels without a ray take no part. The better of two fits from plainLike():
/// fitLens(), and one whose steps may pass lenses that fold back within the image, if it ends at
/// one that does not. Empty as with fitLens().
std::optional<LensFit> convertedLens(const Intrinsics& from, ProjectionModel projection,
                                     DistortionModel distortion, int columns = 48, int rows = 32);

}  // namespace plumbline
