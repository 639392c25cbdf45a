// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/board/joint_target.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SPQRSupport>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/halves.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

constexpr double kLeastShare = 1e-6;  // of a direction's variance, that the others have to say

/// Columns of the joint system: the board's terms, then a tag_edge for every session.
struct JointColumns {
  int board = 0;  ///< with or without the higher terms
  int sessions = 0;

  int size() const { return board + sessions; }
  /// Of an unknown of BoardSystem; -1: held at zero.
  int of(int unknown, int session) const {
    // BoardSystem has tag_edge between the board's terms and the higher ones.
    if (unknown < kBoardTerms) return unknown;
    if (unknown == kBoardTerms) return board + session;
    return unknown - 1 < board ? unknown - 1 : -1;
  }
};

using Sparse = Eigen::SparseMatrix<double>;

struct StackedSystem {
  Sparse A;
  Eigen::VectorXd b;
};

/// All sessions' equations, and below them the square roots of the prior's `information` of every
/// column, about zero.
StackedSystem stackedOf(const std::vector<BoardSystem>& sessions, const JointColumns& columns,
                        const Eigen::VectorXd& information) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> b;
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    const BoardSystem& own = sessions[s];
    const auto first = static_cast<int>(b.size());
    for (int i = 0; i < own.A.rows(); ++i) {
      for (int j = 0; j < own.A.cols(); ++j) {
        const int column = columns.of(j, static_cast<int>(s));
        if (column >= 0 && own.A(i, j) != 0) entries.emplace_back(first + i, column, own.A(i, j));
      }
      b.push_back(own.b[i]);
    }
  }
  for (int j = 0; j < information.size(); ++j) {
    entries.emplace_back(static_cast<int>(b.size()), j, std::sqrt(information[j]));
    b.push_back(0);
  }
  const Eigen::Map<const Eigen::VectorXd> right(b.data(), b.size());
  StackedSystem out{Sparse(right.size(), columns.size()), right};
  out.A.setFromTriplets(entries.begin(), entries.end());
  return out;
}

struct JointSolution {
  Eigen::VectorXd x;
  Eigen::MatrixXd C;
};

/// A E = Q R: x = E R^-1 Q^T b, and its covariance E R^-1 R^-T E^T. The prior keeps R regular.
JointSolution solved(const StackedSystem& system) {
  // Of the rows themselves: their normal equations would have the square of the condition.
  const Eigen::SPQR<Sparse> qr(system.A);
  const auto n = system.A.cols();
  const Eigen::MatrixXd R = Eigen::MatrixXd(qr.matrixR()).topRows(n);
  const Eigen::MatrixXd inverse =
      R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd half = qr.colsPermutation() * inverse;
  return {qr.solve(system.b), half * half.transpose()};
}

/// Orthonormal combinations of the board's terms that the equations of all sessions say less of
/// than 1 / deviation: with A E = Q [R11 R12; 0 0] the columns of E [-R11^-1 R12; 1]. Terms that
/// move no corner of this grid (their columns are zero) are no finding.
std::vector<TargetDirection> undeterminedBy(const std::vector<BoardSystem>& sessions,
                                            const JointColumns& columns, double deviation) {
  const StackedSystem system = stackedOf(sessions, columns, {});
  Eigen::SPQR<Sparse> qr;
  qr.setPivotThreshold(1 / deviation);
  qr.compute(system.A);
  const Eigen::Index n = system.A.cols(), rank = qr.rank();
  const Eigen::MatrixXd R = Eigen::MatrixXd(qr.matrixR()).topRows(rank);
  Eigen::MatrixXd free(n, n - rank);
  free << -R.leftCols(rank).triangularView<Eigen::Upper>().solve(R.rightCols(n - rank)),
      Eigen::MatrixXd::Identity(n - rank, n - rank);
  free = (qr.colsPermutation() * free).eval();
  Eigen::MatrixXd board = free.topRows(columns.board);
  for (int j = 0; j < columns.board; ++j) {
    if (system.A.col(j).norm() == 0) board.row(j).setZero();
  }
  if (board.cols() == 0) return {};
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> basis(board);
  const Eigen::MatrixXd Q =
      basis.householderQ() * Eigen::MatrixXd::Identity(columns.board, basis.rank());
  std::vector<TargetDirection> out;
  for (Eigen::Index k = 0; k < basis.rank(); ++k) out.emplace_back(Q.col(k));
  return out;
}

/// A session's own terms under the prior, its tag_edge eliminated.
JointSolution ownSolution(const BoardSystem& session, const JointColumns& columns,
                          const Eigen::VectorXd& information) {
  const StackedSystem own = stackedOf({session}, {columns.board, 1}, information);
  const JointSolution all = solved(own);
  return {all.x.head(columns.board), all.C.topLeftCorner(columns.board, columns.board)};
}

/// Against the joint estimate; directions of which the other sessions say nothing do not count.
TargetMember compared(const JointSolution& own, const JointSolution& joint) {
  const Eigen::Index n = own.x.size();
  const Eigen::VectorXd d = own.x - joint.x.head(n);
  // Of d: less by C, not more, for the joint estimate is made of the session's own as well.
  const Eigen::MatrixXd C_d = own.C - joint.C.topLeftCorner(n, n);
  const Eigen::LLT<Eigen::MatrixXd> L(own.C);
  const Eigen::MatrixXd half = L.matrixL().solve(C_d);
  const Eigen::MatrixXd share = L.matrixL().solve(half.transpose());
  // Shares of the own variance: 0 along what the other sessions say nothing of, where C is C_i, and
  // 1 where they say all.
  const SymmetricEigen modes = symmetricEigen(0.5 * (share + share.transpose()));
  const Eigen::VectorXd z = modes.vectors.transpose() * L.matrixL().solve(d);
  TargetMember out;
  out.rms = d.norm();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double variance = modes.values[i];
    if (variance < kLeastShare) continue;
    out.chi2 += z[i] * z[i] / variance;
    ++out.terms;
  }
  if (out.terms == 0) return out;
  out.limit = chiSquare99(out.terms);
  const Eigen::VectorXd std = C_d.diagonal().cwiseMax(1e-18).cwiseSqrt();
  Eigen::Index worst = 0;
  d.cwiseAbs().cwiseQuotient(std).maxCoeff(&worst);
  out.worst = targetTermName(static_cast<int>(worst));
  out.difference = d[worst];
  out.std = std[worst];
  return out;
}

/// The solution under a prior of every board term, and how the sessions agree with it.
struct JointFit {
  JointColumns columns;
  JointSolution solution;
  std::vector<TargetMember> members;
  double dispersion = 1;
};

JointFit fitUnder(const std::vector<BoardSystem>& sessions, const Eigen::VectorXd& board_prior,
                  double edge_prior) {
  JointFit out;
  out.columns = {static_cast<int>(board_prior.size()), static_cast<int>(sessions.size())};
  Eigen::VectorXd information = Eigen::VectorXd::Constant(out.columns.size(), edge_prior);
  information.head(out.columns.board) = board_prior;
  out.solution = solved(stackedOf(sessions, out.columns, information));
  double chi2 = 0;
  int terms = 0;
  for (const BoardSystem& session : sessions) {
    // The board's terms and one tag_edge, the session's own.
    const Eigen::VectorXd own = information.head(out.columns.board + 1);
    out.members.push_back(compared(ownSolution(session, out.columns, own), out.solution));
    chi2 += out.members.back().chi2;
    terms += out.members.back().terms;
  }
  if (terms > 0) out.dispersion = std::max(1.0, chi2 / terms);
  return out;
}

/// Whether the higher terms are needed, and the prior that the sessions give them.
struct HigherTest {
  double chi2 = std::numeric_limits<double>::quiet_NaN();
  double limit = std::numeric_limits<double>::quiet_NaN();
  HigherTerms information = HigherTerms::Zero();
};

HigherTest testHigher(const std::vector<BoardSystem>& sessions, double dispersion, double prior) {
  const Eigen::VectorXd weak = Eigen::VectorXd::Constant(kBoardTerms + kHigherTerms, prior);
  const JointFit all = fitUnder(sessions, weak, prior);
  const HigherTerms h = all.solution.x.segment<kHigherTerms>(kBoardTerms);
  const Eigen::MatrixXd C =
      all.solution.C.block<kHigherTerms, kHigherTerms>(kBoardTerms, kBoardTerms);
  Eigen::MatrixXd H = C.llt().solve(Eigen::MatrixXd::Identity(kHigherTerms, kHigherTerms));
  const HigherTerms linear = H * h;
  HigherTest out;
  out.chi2 = h.dot(linear) / dispersion;
  out.limit = chiSquare99(kHigherTerms);
  // Only now: `linear` is of the solution, which has the weak prior. What takes its place is
  // estimated.
  H.diagonal().array() -= prior;
  out.information = higherPosterior(H, linear, {dispersion}).prior.information;
  return out;
}

/// The board's shape; tag_edge and its covariances by the mean over the sessions.
TargetShape shapeOf(const JointFit& fit) {
  const int n = fit.columns.size(), sessions = fit.columns.sessions;
  Eigen::MatrixXd pick = Eigen::MatrixXd::Zero(kTargetTerms, n);
  pick.leftCols<kBoardTerms>().topRows<kBoardTerms>().setIdentity();
  pick.row(kTargetTerms - 1).tail(sessions).setConstant(1.0 / sessions);
  TargetShape shape;
  shape.terms = pick * fit.solution.x;
  // What sessions differ by beyond their deviations, nobody knows of the board (JointTarget).
  shape.covariance = fit.dispersion * pick * fit.solution.C * pick.transpose();
  if (fit.columns.board > kBoardTerms) {
    shape.higher = fit.solution.x.segment<kHigherTerms>(kBoardTerms);
    const HigherTerms variances = fit.solution.C.diagonal().segment<kHigherTerms>(kBoardTerms);
    shape.higher_std = (fit.dispersion * variances).cwiseSqrt();
  }
  return shape;
}

}  // namespace

void JointTargetOptions::check() const {
  requireOption(degree == 2 || degree == 4, "degree", degree, "2 or 4");
  requirePositive("prior_std", prior_std);
}

JointTarget joinTargets(const std::vector<BoardSystem>& sessions,
                        const JointTargetOptions& options) {
  if (sessions.empty()) throw InputError("no session to estimate a target from");
  options.check();
  const double prior = 1 / (options.prior_std * options.prior_std);
  const Eigen::VectorXd twelve = Eigen::VectorXd::Constant(kBoardTerms, prior);
  JointFit fit = fitUnder(sessions, twelve, prior);
  HigherTest higher;
  if (options.degree == 4) higher = testHigher(sessions, fit.dispersion, prior);
  if (higher.chi2 > higher.limit) {
    Eigen::VectorXd all(kBoardTerms + kHigherTerms);
    all << twelve, higher.information;
    fit = fitUnder(sessions, all, prior);
  }
  return {shapeOf(fit), fit.dispersion,
          fit.members,  undeterminedBy(sessions, fit.columns, options.prior_std),
          higher.chi2,  higher.limit};
}

TargetShape JointTarget::undispersed() const {
  TargetShape out = shape;
  *out.covariance /= dispersion;
  if (out.higher_std) *out.higher_std /= std::sqrt(dispersion);
  return out;
}

std::string targetTermName(int term) {
  if (term < kBoardTerms) return kTargetTermNames[term];
  const int function = (term - kBoardTerms) % kHigherFunctions;
  const int degree = function < kCubicFunctions ? 3 : 4;
  // Functions of one degree in the order x..x, x..xy, ..., y..y (HigherBasis).
  const int of_y = degree == 3 ? function : function - kCubicFunctions;
  const char axis = "xyz"[(term - kBoardTerms) / kHigherFunctions];
  return fmt::format("{}_{}{}", axis, std::string(degree - of_y, 'x'), std::string(of_y, 'y'));
}

}  // namespace plumbline
