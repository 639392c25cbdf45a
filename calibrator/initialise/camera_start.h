// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {
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
