// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// Whether each camera without tangential terms asks for them, at a solution of the camera batch.
/// Conrady's displacement by a decentred lens or a tilted sensor (Brown 1966; OpenCV's p1, p2),
///   (du, dv) = s (2 p1 x y + p2 (3 x^2 + y^2),  p1 (x^2 + 3 y^2) + 2 p2 x y),
/// (x, y) = (uv - (pu, pv)) / s, s = pixelsPerRadian() and uv the measured pixel, is put beside the
/// model, and one Gauss-Newton step over intrinsics, poses, p1 and p2, and the board's terms where
/// they were estimated, is taken from the solution, each camera by itself. Their covariance is
/// cluster-robust (information/cluster_robust.h), by the scores where the step ends. To first
/// order: a model that has the terms may find others.
///
/// Poses absorb most of such a displacement, so that neither residuals nor held-out frames show it,
/// and what is estimated from poses turns with them (Decentring::turn).
/// Of every n-th view, 400 to 800 of them where there are as many.
/// Cameras whose model has such terms are not tested, nor those with too few frames, or which these
/// do not determine.
std::vector<Decentring> testDecentring(const CameraProblem& problem, const CameraEstimate& estimate,
                                       const std::vector<CameraCalibration>& cameras);

}  // namespace plumbline
