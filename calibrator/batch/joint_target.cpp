// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/joint_target.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calibrator/base/error.h"
#include "calibrator/batch/halves.h"

namespace plumbline {
namespace {

constexpr int kBoardTerms = kTargetTerms - 1;  // all but tag_edge
constexpr double kLeastShare = 1e-6;  // of a direction's variance, that the others have to say

/// Formal covariance at the size of the larger deviations.
TargetCovariance stretched(const TargetFit& fit) {
  const TargetTerms formal = fit.shape.covariance->diagonal().cwiseSqrt();
  const TargetTerms ratio = fit.std.cwiseQuotient(formal).cwiseMax(1);
  return ratio.asDiagonal() * *fit.shape.covariance * ratio.asDiagonal();
}

/// Against the joint estimate; directions of which the other sessions say nothing do not count.
TargetMember compared(const TargetTerms& own, const TargetCovariance& C_own,
                      const TargetTerms& joint, const TargetCovariance& C) {
  using Board = Eigen::Matrix<double, kBoardTerms, kBoardTerms>;
  const Eigen::Matrix<double, kBoardTerms, 1> d = (own - joint).head<kBoardTerms>();
  const Board C_d = (C_own - C).topLeftCorner<kBoardTerms, kBoardTerms>();
  const Eigen::LLT<Board> L(C_own.topLeftCorner<kBoardTerms, kBoardTerms>());
  const Board half = L.matrixL().solve(C_d);
  const Board share = L.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Board> modes(0.5 * (share + share.transpose()));
  const Eigen::Matrix<double, kBoardTerms, 1> z =
      modes.eigenvectors().transpose() * L.matrixL().solve(d);
  TargetMember out;
  out.rms = d.norm();
  for (int i = 0; i < kBoardTerms; ++i) {
    const double variance = modes.eigenvalues()[i];
    if (variance < kLeastShare) continue;
    out.chi2 += z[i] * z[i] / variance;
    ++out.terms;
  }
  if (out.terms == 0) return out;
  out.limit = chiSquare99(out.terms);
  const auto std = C_d.diagonal().cwiseMax(1e-18).cwiseSqrt().eval();
  Eigen::Index worst = 0;
  d.cwiseAbs().cwiseQuotient(std).maxCoeff(&worst);
  out.worst = kTargetTermNames[static_cast<std::size_t>(worst)];
  out.difference = d[worst];
  out.std = std[worst];
  return out;
}

}  // namespace

JointTarget joinTargets(const std::vector<TargetFit>& sessions, double prior_std) {
  if (sessions.empty()) throw InputError("no session to estimate a target from");
  TargetCovariance information = TargetCovariance::Zero();
  TargetTerms sum = TargetTerms::Zero();
  for (const TargetFit& fit : sessions) {
    if (!fit.shape.covariance) throw InputError("a session has no estimate of the target's shape");
    const Eigen::LLT<TargetCovariance> llt(stretched(fit));
    if (llt.info() != Eigen::Success) throw InputError("a target's covariance is not positive");
    information += llt.solve(TargetCovariance::Identity());
    sum += llt.solve(fit.shape.terms);
  }
  const double again = static_cast<double>(sessions.size() - 1) / (prior_std * prior_std);
  information.diagonal().array() -= again;
  const TargetCovariance C = information.llt().solve(TargetCovariance::Identity());
  JointTarget joint;
  joint.shape.terms = C * sum;
  double chi2 = 0;
  int terms = 0;
  for (const TargetFit& fit : sessions) {
    joint.members.push_back(compared(fit.shape.terms, stretched(fit), joint.shape.terms, C));
    chi2 += joint.members.back().chi2;
    terms += joint.members.back().terms;
  }
  if (terms > 0) joint.dispersion = std::max(1.0, chi2 / terms);
  joint.shape.covariance = joint.dispersion * C;
  return joint;
}

}  // namespace plumbline
