// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/batch/board/board_system.h"

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

/// A combination of terms that all sessions together do not determine: unit vector over the board's
/// terms (kTargetTermNames without tag_edge, then the higher ones where they are estimated).
using TargetDirection = Eigen::VectorXd;

struct JointTarget {
  TargetShape shape;  ///< with its covariance, times the dispersion
  /// Sum of the members' chi-squares over that of their terms, 1 at least (Birge's ratio, squared):
  /// what sessions differ by beyond their deviations is not known of the board either.
  double dispersion = 1;
  std::vector<TargetMember> members;
  std::vector<TargetDirection> undetermined;
  /// Of the terms of degrees 3 and 4 against all zero, over the dispersion; they are estimated
  /// where it exceeds the limit. NaN where they were not asked for.
  double higher_chi2, higher_limit;

  /// The shape with the deviations that the sessions' equations alone give it.
  TargetShape undispersed() const;
};

struct JointTargetOptions {
  int degree = 4;           ///< highest of the terms; 2 or 4
  double prior_std = 5e-3;  ///< of every term, of degrees 3 and 4 while they are tested [m]

  void check() const;  ///< throws InputError naming the field that is out of its range
};

/// One board from several recordings of it: the least-squares solution of all their equations
/// (BoardSystem) stacked, in the board's terms, a tag_edge of its own for every session (it is of
/// recording and detector), and the weak prior. It equals a joint batch of all recordings as far as
/// each is quadratic about its own optimum. The sparse system is factorised by SuiteSparseQR, whose
/// R gives the covariance (R^T R)^-1, times the dispersion; a second one, of the sessions'
/// equations alone, gives rank and null space: columns whose pivot says less than the prior.
///
/// Degrees 3 and 4 (HigherBasis) are taken in where the sessions together ask for them: chi-square
/// of their 27 terms under the weak prior, over the dispersion, beyond its 99 % quantile. Then
/// their variances are estimated (higherPosterior()).
///
/// A session's chi-square is that of t_i - t under C_i - C, t_i its own solution and C_i its
/// covariance (t holds t_i), over the board's terms; directions of which the others say nothing do
/// not count. One session alone agrees with itself. The shape's tag_edge is the mean of all.
/// Throws InputError where there is no session, or the degree is neither 2 nor 4.
JointTarget joinTargets(const std::vector<BoardSystem>& sessions,
                        const JointTargetOptions& options = {});

/// Names of the terms of a TargetDirection: those of kTargetTermNames but tag_edge, then x_xxx,
/// x_xxy, ... z_yyyy.
std::string targetTermName(int term);

}  // namespace plumbline
