// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/results.h"

namespace plumbline {

/// Whether one session shows the board that all of them together do.
struct TargetMember {
  double chi2 = 0;  ///< of its terms against the joint ones, without tag_edge
  int terms = 0;
  double limit = 0;       ///< that one session in a hundred exceeds by chance
  std::string worst;      ///< term that differs by most of its deviations
  double difference = 0;  ///< the session's less the joint one [m]
  double std = 0;         ///< of that difference [m]
  double rms = 0;         ///< over the board's corners, of the session's less the joint shape [m]

  bool agrees() const { return chi2 <= limit; }
};

struct JointTarget {
  TargetShape shape;  ///< with its covariance, times the dispersion
  /// Sum of the members' chi-squares over that of their terms, 1 at least (Birge's ratio, squared):
  /// what sessions differ by beyond their deviations is not known of the board either.
  double dispersion = 1;
  std::vector<TargetMember> members;
};

/// One board from several recordings of it. Each camera batch leaves, with cameras and poses
/// marginalised, a reduced system of the board's terms, whose inverse is the covariance C_i about
/// its estimate t_i (TargetFit). These systems are additive:
///   t = C sum_i C_i^-1 t_i,   C^-1 = sum_i C_i^-1 - (n - 1) / prior^2,
/// C_i being the formal covariance stretched to the larger of formal and cluster-robust deviations
/// (TargetFit::std), and the prior, which is in every C_i, counted once; C is then multiplied by
/// the dispersion. It equals a joint batch of all recordings as far as each is quadratic about its
/// own optimum.
///
/// A session's chi-square is that of t_i - t under C_i - C (t holds t_i), over the eleven terms of
/// the board: tag_edge is of recording and detector. One session alone agrees with itself.
/// Throws InputError where there is no session, or one without a covariance.
JointTarget joinTargets(const std::vector<TargetFit>& sessions, double prior_std);

}  // namespace plumbline
