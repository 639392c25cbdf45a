// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Errors below this [px] mean nothing: what a solver leaves of corners without noise. A floor for
/// ratios of errors.
inline constexpr double kNoiseFloorPx = 1e-3;

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

}  // namespace plumbline
