// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// A camera of this model with its principal point at the image's centre and no distortion.
Intrinsics plainCamera(ProjectionModel projection, DistortionModel distortion,
                       const Resolution& resolution, double focal_px);

/// Candidates for the focal length [px], the likeliest first (at most `count`).
///
/// Every view is explained by a homography for any focal length, but only the right one makes its
/// columns orthogonal and equally long. So each of a ladder of focal lengths is charged with the
/// median, over the views, of the reprojection error that the best pose leaves; local minima are
/// candidates. A plain equidistant camera is a fair model of real fisheyes, as is a plain pinhole
/// of others. Views of the target seen head-on tell nothing: then a field of view of about 70
/// degrees is assumed, and it is for the batch to say that the focal length is not observable.
std::vector<double> focalCandidates(DistortionModel distortion, const Resolution& resolution,
                                    const std::vector<PackedView>& views, int count = 3);

}  // namespace plumbline
