// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// P of an estimate's pose (tangent of Transform) in the truth's frame: B P B^T with
/// B = diag(scale R, R) of the alignment p_truth = scale R p_estimate + t, itself taken as known.
Matrix6d alignedCovariance(const Matrix6d& P, const AlignmentRecord& alignment);

struct Nees {
  std::vector<NeesRecord> parts;  ///< position (3), orientation (3), pose (6)
  std::size_t used = 0;
  std::size_t left_out = 0;  ///< poses whose covariance is not positive definite
};

/// Mean over poses of e^T P^-1 e, with e = boxminus(truth, estimate) and P from `covariances`, one
/// for each pose, in the truth's frame; position and orientation by their own blocks. The bounds
/// hold the mean of n independent consistent poses with 95 %: chi-square quantiles of n dof, over n
/// (Bar-Shalom, Li, Kirubarajan 2001, 5.4.2). Poses of one run err alike for a while, so their mean
/// scatters more than that: a mean just outside is no proof, one far above is overconfidence.
///
/// What is left depends on the alignment: a fit over all poses takes away error that the
/// covariance, which grows from the start, does not expect gone; aligning by the first pose does
/// not.
Nees neesOf(const AlignedPoses& poses, const std::vector<Matrix6d>& covariances);

}  // namespace plumbline
