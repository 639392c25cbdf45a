// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Errors below this [px] mean nothing: what a solver leaves of corners without noise. A floor for
/// ratios of errors.
inline constexpr double kNoiseFloorPx = 1e-3;

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

/// A camera of this model with its principal point at the image's centre and this focal length
/// there: d(pixels)/d(angle) on the axis. Radtan, equidistant and rational without distortion; the
/// others, whose shape is not a correction but the lens, in the middle of what it can be: omni
/// and eucm as a stereographic projection (xi = 1; alpha = 1/2, beta = 1), ds with xi = -0.2 and
/// alpha = 0.6 (on the side of its valley where lenses are found), fov with w = 0.9.
Intrinsics plainCamera(ProjectionModel projection, DistortionModel distortion,
                       const Resolution& resolution, double focal_px);

/// Candidates for the focal length [px], the likeliest first (at most `count`).
///
/// Every view is explained by a homography for any focal length, but only the right one makes its
/// columns orthogonal and equally long. So the cost of each of a ladder of focal lengths is the
/// median, over the views, of the reprojection error that the best pose leaves; local minima are
/// candidates. A plain equidistant camera is a fair model of real fisheyes, as is a plain pinhole
/// of others. Views of the target seen head-on tell nothing: then a field of view of about 70
/// degrees is assumed, and it is for the batch to say that the focal length is not observable.
std::vector<double> focalCandidates(ProjectionModel projection, DistortionModel distortion,
                                    const Resolution& resolution,
                                    const std::vector<PackedView>& views, int count = 3);

/// Poses of the target that one camera found by itself: per frame T_CiF, empty where it has none.
using CameraPoses = std::vector<std::optional<Transform>>;

/// Extrinsics T_C0Ci from every camera's own poses (all of one length, frames in the same order).
///
/// Cameras that share frames are joined by the median of T_CiF T_CjF^-1 over these frames; the
/// maximum spanning tree over the number of shared frames leads from camera 0 to every other.
/// Fails with kNoOverlap, naming the cameras (`names`) that share no frame with the rest.
Result<std::vector<Transform>> extrinsicsFromPoses(const std::vector<CameraPoses>& poses,
                                                   const std::vector<std::string>& names);

/// A transform that gross errors in fewer than half of `transforms` do not spoil: medians of the
/// components of translation and of the rotation vector about a common reference. Not empty.
Transform medianTransform(const std::vector<Transform>& transforms);

}  // namespace plumbline
