// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline {

/// Whether cameras that were held fixed on a recording (`held`: only poses estimated) are those of
/// the same models that its corners ask for, estimated from the held ones as a start. An RMSE does
/// not tell: poses absorb most of a focal length that is wrong by 1 %, and what is left depends on
/// the noise. A caution, never worse, where they differ by more than three standard deviations of
/// the estimate and
///   - a camera's projections by 0.5 px RMS over the image, at infinity, a rotation taken out, to
///     first order: dk^T M dk with the M of imageFitMeanSquare(), dk the difference of intrinsics;
///   - T_C0Ci by 0.5 mm or 0.05 deg.
/// The value is the largest such difference over its bound, 0 where none is significant. Not judged
/// where nothing could be estimated; nothing for models that can only be scored.
std::vector<Finding> judgeHeldCameras(const CameraStageResult& held, const Session& session,
                                      const ScoreOptions& options);

}  // namespace plumbline
