// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// Fills covariance, its entropy, and the cameras' standard deviations from the reduced information
/// `information` (in units of pixel_sigma). Fails with kNotObservable where a direction of the
/// parameters is free, naming it: one whose standard deviation makes its parameters worthless
/// (focal length 20 %, principal point 20 % of the width, distortion 10, translation 1 m,
/// rotation 1 rad).
std::optional<Failure> addCovariance(const Eigen::MatrixXd& information, CameraStageResult& result);

/// Cameras, frames and poses T_FC0 of an estimate, under the session's names.
CameraStageResult resultFrom(const Session& session, const CameraProblem& problem,
                             const CameraEstimate& estimate);

/// Lists every corner of the problem's frames with its residual (rejected ones marked), and fills
/// the statistics, counts and what was offered. Without a list, only statistics and counts.
enum class ResidualList { kKeep, kDrop };
void addResiduals(const Session& session, const CameraProblem& problem,
                  const CameraEstimate& estimate, ResidualList list, CameraStageResult& result);

}  // namespace plumbline
