// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/results.h"

namespace plumbline {

/// Share of each camera's mean squared reprojection error that is systematic (Hagemann, Knorr,
/// Janssen, Stiller: Inferring bias and uncertainty in camera calibration, IJCV 2022):
///   ratio = 1 - noise^2 / error^2, at least 0.
/// noise is the detector's: what residuals leave of an affine function of the corner's place on the
/// board, fitted to each patch of 2 x 2 tags seen whole in a view, per axis, over all degrees of
/// freedom (2 (16 - 3) a patch). Lens, pose and shape of the board err smoothly over a patch; noise
/// does not, nor do tags whose edges look wider, which count as noise. error is that of all used
/// corners per axis, six degrees of freedom less for each frame's pose. A ratio near 0 says that
/// lens model and board leave nothing that noise does not explain; by chance it is below
/// 2 / sqrt(patches).
///
/// Patches do not overlap: tags (2i, 2j) to (2i + 1, 2j + 1). `stage` has the residuals.
std::vector<BiasRatio> biasRatios(const AprilGrid& board, const CameraStageResult& stage);

}  // namespace plumbline
