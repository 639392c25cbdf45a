// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/linear/bordered_chain.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <thread>

namespace plumbline {
namespace {

constexpr int kB = kChainBlock;
using BlockVector = Eigen::Matrix<double, kB, 1>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using LowerFactor = Eigen::Matrix<double, kB, kB, Eigen::RowMajor>;

/// One eliminated block: L of its pivot, and L^-1 (coupling to the neighbour | border | gradient).
struct EliminatedBlock {
  LowerFactor L;
  ChainBorderRows panel;
};

/// In-place Cholesky of a symmetric matrix given by its upper triangle; false if not positive.
bool factorise(const ChainMatrix& A, LowerFactor& L) {
  L.setZero();
  for (int j = 0; j < kB; ++j) {
    const double pivot = A(j, j) - L.row(j).head(j).squaredNorm();
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    L(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < kB; ++i) {
      L(i, j) = (A(j, i) - L.row(i).head(j).dot(L.row(j).head(j))) / L(j, j);
    }
  }
  return true;
}

/// panel <- L^-1 panel, row operations over contiguous rows.
void forwardSubstitute(const LowerFactor& L, ChainBorderRows& panel) {
  for (int i = 0; i < kB; ++i) {
    for (int k = 0; k < i; ++k) panel.row(i) -= L(i, k) * panel.row(k);
    panel.row(i) *= 1 / L(i, i);
  }
}

/// panel <- L'^-1 panel.
void backSubstituteRows(const LowerFactor& L, ChainBorderRows& panel) {
  for (int i = kB - 1; i >= 0; --i) {
    panel.row(i) *= 1 / L(i, i);
    for (int k = 0; k < i; ++k) panel.row(k) -= L(i, k) * panel.row(i);
  }
}

/// x <- L'^-1 x.
void backSubstitute(const LowerFactor& L, BlockVector& x) {
  for (int i = kB - 1; i >= 0; --i) {
    x(i) /= L(i, i);
    for (int k = 0; k < i; ++k) x(k) -= L(i, k) * x(i);
  }
}

/// What elimination hands on: to the neighbour's block, and (summed) to the border.
struct Carry {
  explicit Carry(int border_columns)
      : rows(ChainBorderRows::Zero(kB, border_columns)),
        border(RowMatrix::Zero(border_columns, border_columns)) {}
  ChainMatrix block = ChainMatrix::Zero();
  ChainBorderRows rows;
  RowMatrix border;  // upper triangle; last column: the gradient's part; corner: its square
  double log_det = 0;
  bool positive = true;
};

class Elimination {
 public:
  Elimination(const BorderedChain& system, const ChainOptions& options)
      : system_(system),
        options_(options),
        columns_(system.border() + 1),
        middle_(system.blocks() / 2),
        eliminated_(static_cast<std::size_t>(system.blocks())) {}

  std::optional<ChainSolution> run() {
    Carry front(columns_);
    Carry back(columns_);
    inParallel([&] { sweep(0, middle_, +1, front); },
               [&] { sweep(system_.blocks() - 1, middle_, -1, back); });
    if (!front.positive || !back.positive) return std::nullopt;
    front.block += back.block;
    front.rows += back.rows;
    front.border += back.border;
    front.log_det += back.log_det;
    if (system_.blocks() > 0) eliminate(middle_, 0, front);
    if (!front.positive) return std::nullopt;
    return substitute(front);
  }

  /// After run() has succeeded.
  ChainCovariance covariance(const Eigen::MatrixXd& border_information) const {
    const int m = system_.border();
    const int n = system_.blocks();
    ChainCovariance out;
    out.border = border_information.llt().solve(Eigen::MatrixXd::Identity(m, m));
    out.border = (0.5 * (out.border + out.border.transpose())).eval();
    out.diagonal.resize(static_cast<std::size_t>(n));
    out.next.assign(static_cast<std::size_t>(n), ChainMatrix::Zero());
    out.to_border.resize(static_cast<std::size_t>(n));
    if (n == 0) return out;
    blockCovariance(middle_, 0, out);
    inParallel(
        [&] {
          for (int i = middle_ - 1; i >= 0; --i) blockCovariance(i, +1, out);
        },
        [&] {
          for (int i = middle_ + 1; i < n; ++i) blockCovariance(i, -1, out);
        });
    return out;
  }

 private:
  template <class First, class Second>
  void inParallel(First first, Second second) const {
    if (options_.threads < 2) {
      first();
      second();
      return;
    }
    std::thread other(second);
    first();
    other.join();
  }

  /// Eliminates blocks first, first + direction, ... up to (without) `end`.
  void sweep(int first, int end, int direction, Carry& carry) {
    for (int i = first; i != end && carry.positive; i += direction) eliminate(i, direction, carry);
  }

  /// Eliminates block i towards its neighbour i + direction (none for direction 0).
  void eliminate(int i, int direction, Carry& carry) {
    const auto at = static_cast<std::size_t>(i);
    EliminatedBlock& e = eliminated_[at];
    ChainMatrix A = system_.diagonal[at];
    A.diagonal() *= 1 + options_.damping;
    A -= carry.block;
    if (!factorise(A, e.L)) {
      carry.positive = false;
      return;
    }
    const int neighbour = direction == 0 ? 0 : kB;
    e.panel.resize(kB, neighbour + columns_);
    if (direction > 0) e.panel.leftCols(kB) = system_.next[at];
    if (direction < 0) e.panel.leftCols(kB) = system_.next[at - 1].transpose();
    e.panel.rightCols(columns_) = system_.to_border[at] - carry.rows;
    forwardSubstitute(e.L, e.panel);
    carry.log_det += 2 * e.L.diagonal().array().log().sum();
    handOn(e.panel, neighbour, carry);
  }

  /// Products of the eliminated rows: upper triangles by row operations, in a fixed order.
  void handOn(const ChainBorderRows& panel, int neighbour, Carry& carry) const {
    if (neighbour > 0) {
      const auto N = panel.leftCols<kB>();
      const auto C = panel.rightCols(columns_);
      carry.block.setZero();
      carry.rows.setZero();
      for (int k = 0; k < kB; ++k) {
        for (int j = 0; j < kB; ++j) {
          carry.block.col(j).head(j + 1) += N(k, j) * N.row(k).head(j + 1).transpose();
          carry.rows.row(j) += N(k, j) * C.row(k);
        }
      }
    }
    const auto C = panel.rightCols(columns_);
    for (int k = 0; k < kB; ++k) {
      for (int j = 0; j < columns_; ++j) {
        carry.border.row(j).tail(columns_ - j) += C(k, j) * C.row(k).tail(columns_ - j);
      }
    }
  }

  std::optional<ChainSolution> substitute(const Carry& carry) const {
    const int m = system_.border();
    ChainSolution out;
    Eigen::MatrixXd S = system_.border_block;
    S.diagonal() *= 1 + options_.damping;
    S -= carry.border.topLeftCorner(m, m);
    out.border_information = S.selfadjointView<Eigen::Upper>();
    const Eigen::VectorXd s = system_.border_gradient - carry.border.col(m).head(m);
    const Eigen::LLT<Eigen::MatrixXd> llt(out.border_information);
    if (llt.info() != Eigen::Success) return std::nullopt;
    out.border_step = -llt.solve(s);
    if (!out.border_step.allFinite()) return std::nullopt;
    out.chain_log_det = carry.log_det;
    out.border_log_det = 2 * llt.matrixLLT().diagonal().array().log().sum();
    out.decrement = carry.border(m, m) - s.dot(out.border_step);
    backSweeps(out);
    return out;
  }

  void backSweeps(ChainSolution& out) const {
    const int n = system_.blocks();
    out.step.resize(static_cast<std::size_t>(n));
    if (n == 0) return;
    blockStep(middle_, 0, out);
    inParallel(
        [&] {
          for (int i = middle_ - 1; i >= 0; --i) blockStep(i, +1, out);
        },
        [&] {
          for (int i = middle_ + 1; i < n; ++i) blockStep(i, -1, out);
        });
  }

  void blockStep(int i, int direction, ChainSolution& out) const {
    const EliminatedBlock& e = eliminated_[static_cast<std::size_t>(i)];
    const int m = system_.border();
    BlockVector x = -e.panel.rightCols<1>();
    if (m > 0) x -= e.panel.middleCols(e.panel.cols() - columns_, m) * out.border_step;
    if (direction != 0) {
      x -= e.panel.leftCols<kB>() * out.step[static_cast<std::size_t>(i + direction)];
    }
    backSubstitute(e.L, x);
    out.step[static_cast<std::size_t>(i)] = x;
  }

  /// Covariance of (neighbour, border) of an eliminated block.
  RowMatrix neighbourCovariance(int neighbour, const ChainCovariance& out) const {
    const int m = system_.border();
    if (neighbour < 0) return out.border;
    const auto at = static_cast<std::size_t>(neighbour);
    RowMatrix S(kB + m, kB + m);
    S.topLeftCorner<kB, kB>() = out.diagonal[at];
    S.topRightCorner(kB, m) = out.to_border[at];
    S.bottomLeftCorner(m, kB) = out.to_border[at].transpose();
    S.bottomRightCorner(m, m) = out.border;
    return S;
  }

  void blockCovariance(int i, int direction, ChainCovariance& out) const {
    const auto at = static_cast<std::size_t>(i);
    const EliminatedBlock& e = eliminated_[at];
    const int m = system_.border();
    const int coupled = static_cast<int>(e.panel.cols()) - 1;  // neighbour, if any, and border
    // L^-1 (panel | I), and then L'^-1 of it: K and (L L')^-1 side by side.
    ChainBorderRows both(kB, coupled + kB);
    both.leftCols(coupled) = e.panel.leftCols(coupled);
    ChainBorderRows identity = ChainBorderRows::Identity(kB, kB);
    forwardSubstitute(e.L, identity);
    both.rightCols(kB) = identity;
    backSubstituteRows(e.L, both);
    const ChainBorderRows K = both.leftCols(coupled);
    const ChainBorderRows KS =
        K.lazyProduct(neighbourCovariance(direction == 0 ? -1 : i + direction, out));
    const ChainMatrix S_ii = both.rightCols(kB) + KS.lazyProduct(K.transpose());
    out.diagonal[at] = 0.5 * (S_ii + S_ii.transpose());
    out.to_border[at] = -KS.rightCols(m);
    if (direction > 0) out.next[at] = -KS.leftCols(kB);
    if (direction < 0) out.next[at - 1] = -KS.leftCols(kB).transpose();
  }

  const BorderedChain& system_;
  const ChainOptions& options_;
  const int columns_;  // border and gradient
  const int middle_;
  std::vector<EliminatedBlock> eliminated_;
};

}  // namespace

BorderedChain::BorderedChain(int blocks, int border)
    : diagonal(static_cast<std::size_t>(blocks), ChainMatrix::Zero()),
      next(static_cast<std::size_t>(blocks), ChainMatrix::Zero()),
      to_border(static_cast<std::size_t>(blocks), ChainBorderRows::Zero(kB, border + 1)),
      border_block(Eigen::MatrixXd::Zero(border, border)),
      border_gradient(Eigen::VectorXd::Zero(border)) {}

void BorderedChain::setZero() {
  for (ChainMatrix& D : diagonal) D.setZero();
  for (ChainMatrix& N : next) N.setZero();
  for (ChainBorderRows& C : to_border) C.setZero();
  border_block.setZero();
  border_gradient.setZero();
}

std::optional<ChainSolution> solveChain(const BorderedChain& system, const ChainOptions& options) {
  return Elimination(system, options).run();
}

std::optional<ChainInverse> invertChain(const BorderedChain& system, const ChainOptions& options) {
  Elimination elimination(system, options);
  auto solution = elimination.run();
  if (!solution) return std::nullopt;
  ChainInverse out{std::move(*solution), {}};
  out.covariance = elimination.covariance(out.solution.border_information);
  return out;
}

}  // namespace plumbline
