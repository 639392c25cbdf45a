// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/faults/score_tests.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrator/base/statistics/distributions.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/information/cluster_robust.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Whatever the units: below 1e-30 on the diagonal stands nothing, and a share of 1e-12 keeps
/// columns finite that say the same.
MatrixXd inverseOf(const MatrixXd& A) { return finiteInverse(A, 1e-30, 1e-12); }

template <class Entry>
VectorXd vectorOf(const Terms& a, const Entry& entry) {
  return VectorXd::NullaryExpr(a.size(), [&](Index i) { return entry(a[i]); });
}

template <class Entry>
MatrixXd matrix(const Terms& a, const Terms& b, const Entry& entry) {
  return MatrixXd::NullaryExpr(a.size(), b.size(),
                               [&](Index i, Index j) { return entry(a[i], b[j]); });
}

/// T_SC0 and the time offset among the first columns, which are the border's.
Eigen::Matrix<double, 7, 1> listed(const VectorXd& model) {
  Eigen::Matrix<double, 7, 1> out;
  out << model.head<6>(), model(BorderLayout::kOffset);
  return out;
}

/// Columns span the directions to test: all, or those that the motion determines (see test()).
MatrixXd testedDirections(const MatrixXd& A, const VectorXd& s, double range,
                          double overdispersion) {
  // Second order makes estimates of ten deviations out there (linearRange() in diagnosis.cpp).
  constexpr double kUndetermined = 0.1;
  const Index n = A.cols();
  if ((inverseOf(A) * s).cwiseAbs().maxCoeff() <= range) return MatrixXd::Identity(n, n);
  const SymmetricEigen eigen = symmetricEigen(A);
  Index held = 0;
  while (held < n && !(eigen.values(held) * std::pow(kUndetermined * range, 2) >= overdispersion)) {
    ++held;
  }
  if (held == 0 || held == n) return MatrixXd::Identity(n, n);
  return eigen.vectors.rightCols(n - held);
}

/// Those of components that lie in the directions Q; NaN of the others.
VectorXd deviationsAlong(const MatrixXd& Q, const MatrixXd& C) {
  constexpr double kLiesIn = 0.99;  // cosine squared
  VectorXd std = (Q * C * Q.transpose()).diagonal().cwiseSqrt();
  for (Index k = 0; k < std.size(); ++k) {
    if (Q.row(k).squaredNorm() < kLiesIn) std(k) = std::numeric_limits<double>::quiet_NaN();
  }
  return std;
}

}  // namespace

Scores::Scores(std::vector<ScoreBlock> blocks) : blocks_(std::move(blocks)), tails_(blocks_) {
  for (const ScoreBlock& block : blocks_) seen_ += block.views > 0 ? 1 : 0;
  // Once, so that a term that begins at any block costs one look-up.
  for (std::size_t b = tails_.size() - 1; b-- > 0;) {
    tails_[b].gradient += tails_[b + 1].gradient;
    tails_[b].information += tails_[b + 1].information;
  }
}

VectorXd Scores::gradient(const Terms& terms) const {
  return vectorOf(terms, [&](const Term& t) { return tails_[t.from].gradient(t.column); });
}

MatrixXd Scores::information(const Terms& a, const Terms& b) const {
  return matrix(a, b, [&](const Term& p, const Term& q) {
    // Both act from the later of the two on.
    return tails_[std::max(p.from, q.from)].information(p.column, q.column);
  });
}

VectorXd Scores::gradient(const Terms& terms, std::size_t block) const {
  return vectorOf(terms, [&](const Term& t) {
    return block >= t.from ? blocks_[block].gradient(t.column) : 0.0;
  });
}

MatrixXd Scores::information(const Terms& a, const Terms& b, std::size_t block) const {
  return matrix(a, b, [&](const Term& p, const Term& q) {
    const bool act = block >= std::max(p.from, q.from);
    return act ? blocks_[block].information(p.column, q.column) : 0.0;
  });
}

double significanceOf(double chi2, int dof) {
  // cbrt(chi2 / dof) is nearly normal, with mean 1 - v and variance v.
  const double v = 2.0 / (9.0 * dof);
  return (std::cbrt(chi2 / dof) - (1 - v)) / std::sqrt(v);
}

double significanceBound(double deviations, int dof, std::size_t blocks) {
  constexpr double kDispersions = 3;
  const double dispersion_dof = kDispersions * (static_cast<double>(blocks) - 1);
  const double chi2 = dof * fisherTailQuantile(dof, dispersion_dof, normalTail(deviations));
  return std::max(deviations, significanceOf(chi2, dof));
}

ScoreTests::ScoreTests(const Scores& scores, Terms model)
    : scores_(scores),
      model_(std::move(model)),
      S_(inverseOf(scores.information(model_, model_))),
      gradient_(scores.gradient(model_)) {
  MatrixXd V = MatrixXd::Zero(S_.rows(), S_.cols());
  for (std::size_t b = 0; b < scores.count(); ++b) {
    const VectorXd s = scoreAtEstimate(b);
    V += s * s.transpose();
  }
  const auto n = static_cast<double>(scores.seen());
  // At the estimate all scores add up to zero: one of them follows from the others.
  robust_variance_ = n / (n - 1) * (S_ * V * S_).diagonal();
}

Eigen::Matrix<double, 7, 1> ScoreTests::robustStd() const {
  return listed(robust_variance_.cwiseSqrt());
}

Eigen::Matrix<double, 7, 1> ScoreTests::formalStd() const {
  return listed(S_.diagonal().cwiseSqrt());
}

VectorXd ScoreTests::scoreAtEstimate(std::size_t block) const {
  return scores_.gradient(model_, block) -
         scores_.information(model_, model_, block) * (S_ * gradient_);
}

RobustDeviations ScoreTests::clusterRobustDeviations(const MatrixXd& combinations) const {
  std::vector<std::size_t> seen;  // the others add nothing to any sum
  for (std::size_t b = 0; b < scores_.count(); ++b) {
    if (scores_.isSeen(b)) seen.push_back(b);
  }
  const auto count = static_cast<int>(seen.size());
  MatrixXd pieces(S_.rows(), count);
  for (int b = 0; b < count; ++b) pieces.col(b) = scoreAtEstimate(seen[b]);
  const double length = correlationLength(pieces, S_);
  const int joined = blocksOf(count, length);
  BlockScores blocks{MatrixXd::Zero(S_.rows(), joined), {}};
  for (int j = 0; j < joined; ++j) {
    MatrixXd information = MatrixXd::Zero(S_.rows(), S_.cols());
    // About equally many to each, in time order.
    for (int b = j * count / joined; b < (j + 1) * count / joined; ++b) {
      blocks.scores.col(j) += pieces.col(b);
      information += scores_.information(model_, model_, seen[b]);
    }
    blocks.information.push_back(std::move(information));
  }
  const ClusterRobust robust = clusterRobust(blocks, S_);
  const double share = shareWithin(static_cast<double>(count) / joined, length);
  const MatrixXd covariance = combinations * robust.matrix * combinations.transpose() / share;
  RobustDeviations out{covariance.diagonal().cwiseSqrt(), VectorXd(combinations.rows())};
  for (Index k = 0; k < out.dof.size(); ++k) {
    out.dof(k) = robust.degrees.of(combinations.row(k).transpose());
  }
  return out;
}

MatrixXd ScoreTests::response(const Terms& held) const {
  // The model's gradient stays zero: I_mm dm + I_mh dh = 0.
  return -(S_ * scores_.information(model_, held));
}

FaultTest ScoreTests::test(const Terms& fault, double range) const {
  const MatrixXd I = scores_.information(fault, model_);
  const MatrixXd P = S_ * I.transpose();  // minus the model's response to the fault
  // Model eliminated: A = I_ff - I_fm S I_mf, s = s_f - I_fm S s_m; both in the directions tested.
  const MatrixXd A = scores_.information(fault, fault) - I * P;
  VectorXd s = scores_.gradient(fault) - P.transpose() * gradient_;
  const MatrixXd Q = testedDirections(A, s, range, overdispersion());
  const MatrixXd A_inverse = inverseOf(Q.transpose() * A * Q);
  s = Q.transpose() * s;
  FaultTest out;
  out.dof = static_cast<int>(Q.cols());
  const VectorXd along = -A_inverse * s;
  out.estimate = Q * along;
  // Sandwich: A^-1 V A^-1, V the scatter of the blocks' scores where white noise has A.
  const MatrixXd V = scatter(fault, P, out.estimate, out.dof);
  const MatrixXd C = A_inverse * (Q.transpose() * V * Q) * A_inverse;
  out.std = deviationsAlong(Q, C);
  out.explained = s.dot(A_inverse * s) / overdispersion();
  out.chi2 = std::min(along.dot(inverseOf(C) * along), out.explained);
  out.significance = significanceOf(out.chi2, out.dof);
  // What the calibration would change by with the fault in the model.
  out.shift = listed(-(P * out.estimate));
  out.shift_sigma = out.shift.cwiseAbs().cwiseQuotient(robustStd()).maxCoeff();
  return out;
}

double ScoreTests::overdispersion() const {
  const Eigen::Array<double, 7, 1> ratio =
      robustStd().array().max(1e-30) / formalStd().array().max(1e-30);
  // Geometric mean of ratios of variances.
  return std::exp(2 * ratio.log().mean());
}

/// Without the fault at its estimate the scores of all blocks would have its mean in them, and the
/// fault would hide behind its own size. A block's score moves by its information times the step.
MatrixXd ScoreTests::scatter(const Terms& fault, const MatrixXd& P, const VectorXd& estimate,
                             int dof) const {
  MatrixXd V = MatrixXd::Zero(P.cols(), P.cols());
  const VectorXd step = -S_ * gradient_ - P * estimate;  // of the model, with the fault
  for (std::size_t b = 0; b < scores_.count(); ++b) {
    const MatrixXd I = scores_.information(fault, model_, b);
    const VectorXd of_fault =
        scores_.gradient(fault, b) + I * step + scores_.information(fault, fault, b) * estimate;
    const VectorXd of_model = scores_.gradient(model_, b) + I.transpose() * estimate +
                              scores_.information(model_, model_, b) * step;
    const VectorXd s = of_fault - P.transpose() * of_model;
    V += s * s.transpose();
  }
  const auto n = static_cast<double>(scores_.seen());
  return n / std::max(1.0, n - 1 - dof) * V;
}

}  // namespace plumbline
