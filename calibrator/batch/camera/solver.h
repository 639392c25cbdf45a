// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/batch/camera/problem.h"

namespace plumbline {

struct CameraSolverOptions {
  int max_iterations = 100;
  /// Converged where the step that remains is shorter than this, in standard deviations of all
  /// parameters together: sqrt(b^T H^-1 b).
  double tolerance = 1e-7;
  /// The cost may also settle: converged where a full step promises less than this share of it,
  /// which is as far as rounding lets it be compared.
  double cost_tolerance = 1e-15;
};

struct CameraSolution {
  CameraEstimate estimate;
  CameraNormals normals;  ///< at the estimate, weighted as problem.gram says
  bool converged = false;
  int iterations = 0;  ///< steps tried
};

/// Levenberg-Marquardt on the structured normal equations: every frame's pose is eliminated where
/// the frame stands, and the cameras' parameters are a small dense system.
///
/// With a loss the first steps re-weight (GramOptions::triggs_clamp as given); near the minimum the
/// loss' whole second derivative takes part, without which convergence is slow.
CameraSolution solveCameraProblem(const CameraProblem& problem, const CameraEstimate& start,
                                  const CameraSolverOptions& options = {});

}  // namespace plumbline
