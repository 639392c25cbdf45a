// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/linear/block_arrow.h"

#include <Eigen/Cholesky>

#include "calibrator/base/parallel.h"
#include "calibrator/linear/dense.h"

namespace plumbline {
namespace {

constexpr int kB = kChainBlock;
using BlockVector = Eigen::Matrix<double, kB, 1>;

// Rows of a block while it is eliminated: (pivot | coupling to the neighbour | border | gradient),
// each part filled up with zeros to whole lanes.
constexpr int kPart = 16;  // a block's columns, filled up
constexpr int kNeighbour = kPart;
constexpr int kBorder = 2 * kPart;

constexpr int filledUp(int columns) { return (columns + kRowLanes - 1) / kRowLanes * kRowLanes; }

/// What elimination hands on, J' J of the eliminated rows' coupled columns (upper triangle): to the
/// neighbour's block in the rows of the first part, and (summed) to the border in the others.
struct Carry {
  explicit Carry(int columns) : gram(RowMatrix::Zero(columns, columns)) {}
  RowMatrix gram;
  bool positive = true;
};

/// Blocks are eliminated from the ends towards the middle, the middle one last. Of a block with
/// pivot A = L L' and coupled columns c = (N | C | b) the rows keep (L' | L^-1 c), and (L^-1 c)'
/// (L^-1 c) = c' A^-1 c is what its Schur complement takes off the neighbour and the border. The
/// gradient goes along as one more column of the border: forward substitution costs no pass of its
/// own.
class Elimination {
 public:
  /// `released`, if given, is the system itself: its couplings to the border go as they are used.
  Elimination(const BlockArrow& system, const ChainOptions& options, BlockArrow* released = nullptr)
      : system_(system),
        released_(released),
        options_(options),
        border_(system.border()),
        columns_(kBorder + filledUp(system.border() + 1)),
        middle_(system.blocks() / 2),
        eliminated_(system.blocks()) {}

  // From both ends towards the middle, whatever the number of threads: the halves meet in one
  // block, and the order of all sums is the same for one thread and for two.
  std::optional<Carry> eliminateAll() {
    Carry front(columns_ - kNeighbour);
    Carry back(columns_ - kNeighbour);
    inParallel(
        options_.threads, [&] { sweep(0, middle_, +1, front); },
        [&] { sweep(system_.blocks() - 1, middle_, -1, back); });
    if (!front.positive || !back.positive) return std::nullopt;
    // Both neighbours of the middle block write to it: their carries add up in its rows as well.
    front.gram += back.gram;
    if (system_.blocks() > 0) eliminate(middle_, 0, front);
    if (!front.positive) return std::nullopt;
    return front;
  }

  std::optional<ChainSolution> run() {
    const auto carry = eliminateAll();
    return carry ? substitute(*carry) : std::nullopt;
  }

  /// After eliminateAll() has succeeded, from the middle outwards; each block's rows are released.
  std::vector<ChainResponse> responses() {
    const auto n = static_cast<int>(eliminated_.size());
    std::vector<ChainResponse> out(eliminated_.size());
    if (n == 0) return out;
    blockResponse(middle_, 0, out);
    for (int i = middle_ - 1; i >= 0; --i) blockResponse(i, +1, out);
    for (int i = middle_ + 1; i < n; ++i) blockResponse(i, -1, out);
    return out;
  }

  /// After run() has succeeded.
  ChainCovariance covariance(const Eigen::MatrixXd& border_information) const {
    const int m = system_.border();
    const int n = system_.blocks();
    ChainCovariance out;
    out.border = border_information.llt().solve(Eigen::MatrixXd::Identity(m, m));
    out.border = (0.5 * (out.border + out.border.transpose())).eval();
    out.diagonal.resize(n);
    out.next.assign(n, ChainMatrix::Zero());
    out.to_border.resize(n);
    if (n == 0) return out;
    fromMiddle([&](int i, int direction) { blockCovariance(i, direction, out); });
    return out;
  }

 private:
  /// Eliminates blocks first, first + direction, ... up to (without) `end`.
  void sweep(int first, int end, int direction, Carry& carry) {
    for (int i = first; i != end && carry.positive; i += direction) eliminate(i, direction, carry);
  }

  /// Eliminates block i towards its neighbour i + direction (none for direction 0).
  void eliminate(int i, int direction, Carry& carry) {
    RowMatrix& rows = eliminated_[i];
    rows.setZero(kB, columns_);
    // Only the upper triangle: factoriseRows() reads no more.
    for (int r = 0; r < kB; ++r) {
      for (int c = r; c < kB; ++c) rows(r, c) = system_.diagonal[i](r, c);
      rows(r, r) *= 1 + options_.damping;
    }
    // Damping scales the system's own diagonal, before the Schur complement of the blocks before.
    rows.leftCols<kPart>() -= carry.gram.topLeftCorner<kB, kPart>();
    if (direction > 0) rows.middleCols<kB>(kNeighbour) = system_.next[i];
    if (direction < 0) rows.middleCols<kB>(kNeighbour) = system_.next[i - 1].transpose();
    const int border = system_.border() + 1;
    rows.middleCols(kBorder, border) =
        system_.to_border[i] - carry.gram.block(0, kPart, kB, border);
    if (released_) released_->to_border[i].resize(kB, 0);
    carry.positive = factoriseRows(rows);
    if (!carry.positive) return;
    // Rows of the first part were this block's own and are used up; from here on they are the
    // neighbour's. Those of the border go on summing.
    carry.gram.topRows<kPart>().setZero();
    addGram(rows, kNeighbour, carry.gram);
  }

  std::optional<ChainSolution> substitute(const Carry& carry) const {
    const int m = system_.border();
    // S = B - C' (chain)^-1 C and s = b_B - C' (chain)^-1 b; S x_B = -s. (The damped chain, and B
    // damped likewise.)
    const auto handed_on = carry.gram.block(kPart, kPart, m + 1, m + 1);
    ChainSolution out;
    Eigen::MatrixXd S = system_.border_block;
    S.diagonal() *= 1 + options_.damping;
    S -= handed_on.topLeftCorner(m, m);
    out.border_information = S.selfadjointView<Eigen::Upper>();
    const Eigen::VectorXd s = system_.border_gradient - handed_on.col(m).head(m);
    const Eigen::LLT<Eigen::MatrixXd> llt(out.border_information);
    if (llt.info() != Eigen::Success) return std::nullopt;
    out.border_step = -llt.solve(s);
    if (!out.border_step.allFinite()) return std::nullopt;
    // b' H^-1 b: the eliminated blocks' share has been summed as the gradient column went along;
    // the border adds s' S^-1 s = -s' x_B.
    out.decrement = handed_on(m, m) - s.dot(out.border_step);
    out.step.resize(system_.blocks());
    if (system_.blocks() == 0) return out;
    fromMiddle([&](int i, int direction) { blockStep(i, direction, out); });
    return out;
  }

  /// work(i, direction) for every block, from the middle to both ends; block i + direction is done
  /// before (none for direction 0).
  template <class Work>
  void fromMiddle(const Work& work) const {
    work(middle_, 0);
    inParallel(
        options_.threads,
        [&] {
          for (int i = middle_ - 1; i >= 0; --i) work(i, +1);
        },
        [&] {
          for (int i = middle_ + 1; i < system_.blocks(); ++i) work(i, -1);
        });
  }

  /// L' x_i = -L^-1 (b_i + C_i x_B + N x_neighbour), whose terms stand in the rows as they are.
  void blockStep(int i, int direction, ChainSolution& out) const {
    const RowMatrix& rows = eliminated_[i];
    const int m = system_.border();
    BlockVector x = -rows.col(kBorder + m);
    if (m > 0) x.noalias() -= rows.middleCols(kBorder, m) * out.border_step;
    if (direction != 0) {
      const BlockVector& next = out.step[i + direction];
      x.noalias() -= rows.middleCols<kB>(kNeighbour).lazyProduct(next);
    }
    for (int r = kB - 1; r >= 0; --r) {
      for (int k = r + 1; k < kB; ++k) x(r) -= rows(r, k) * x(k);
      x(r) /= rows(r, r);
    }
    out.step[i] = x;
  }

  /// Covariance of (neighbour | border) of an eliminated block, in the columns of its rows; zero
  /// where there is no neighbour and in the columns that fill up.
  RowMatrix coupledCovariance(int neighbour, const ChainCovariance& out) const {
    const int m = system_.border();
    const int coupled = columns_ - kNeighbour;
    RowMatrix S = RowMatrix::Zero(coupled, coupled);
    S.block(kPart, kPart, m, m) = out.border;
    if (neighbour < 0) return S;
    S.topLeftCorner<kB, kB>() = out.diagonal[neighbour];
    S.block(0, kPart, kB, m) = out.to_border[neighbour];
    S.block(kPart, 0, m, kB) = out.to_border[neighbour].transpose();
    return S;
  }

  // With x_i = -K (neighbour | border) + noise of covariance (L L')^-1, outwards from the middle:
  // only the blocks of the inverse that the system itself has are formed (Takahashi's recursion).
  void blockCovariance(int i, int direction, ChainCovariance& out) const {
    const RowMatrix& rows = eliminated_[i];
    const int m = system_.border();
    // K = A^-1 c = L'^-1 (L^-1 c). Its gradient column meets only zeros of S.
    const RowMatrix K = solveUpper(rows, rows.rightCols(columns_ - kNeighbour));
    const RowMatrix KS = product(K, coupledCovariance(direction == 0 ? -1 : i + direction, out));
    RowMatrix identity = RowMatrix::Zero(kB, kPart);
    identity.leftCols<kB>().setIdentity();
    const RowMatrix inverse = solveUpper(rows, identity);  // of L' = U
    RowMatrix transposed = RowMatrix::Zero(columns_ - kNeighbour, kPart);
    transposed.leftCols<kB>() = K.transpose();
    const ChainMatrix S_ii = product(KS, transposed).leftCols<kB>() +
                             inverse.leftCols<kB>().lazyProduct(inverse.leftCols<kB>().transpose());
    out.diagonal[i] = 0.5 * (S_ii + S_ii.transpose());
    out.to_border[i] = -KS.middleCols(kPart, m);
    if (direction > 0) out.next[i] = -KS.leftCols<kB>();
    if (direction < 0) out.next[i - 1] = -KS.leftCols<kB>().transpose();
  }

  /// W_i = -K_B - K_N W_neighbour, the columns of K = A^-1 (N | C) by whom they couple to.
  void blockResponse(int i, int direction, std::vector<ChainResponse>& out) {
    RowMatrix& rows = eliminated_[i];
    const RowMatrix K = solveUpper(rows, rows.rightCols(columns_ - kNeighbour));
    rows.resize(0, 0);
    out[i] = -K.middleCols(kPart, border_);
    if (direction == 0) return;
    out[i].noalias() -= K.leftCols<kB>() * out[i + direction];
  }

  const BlockArrow& system_;
  BlockArrow* released_;
  const ChainOptions& options_;
  const int border_;
  const int columns_;  // of the rows of a block
  const int middle_;
  /// Of each block L^-1 (pivot, which is then L', | neighbour | border | gradient); below the
  /// diagonal of L' stands nothing of use.
  std::vector<RowMatrix> eliminated_;
};

}  // namespace

BlockArrow::BlockArrow(int blocks, int border)
    : diagonal(blocks, ChainMatrix::Zero()),
      next(blocks, ChainMatrix::Zero()),
      to_border(blocks, ChainBorderRows::Zero(kB, border + 1)),
      border_block(Eigen::MatrixXd::Zero(border, border)),
      border_gradient(Eigen::VectorXd::Zero(border)) {}

void BlockArrow::hold(int parameter) {
  border_block.row(parameter).setZero();
  border_block.col(parameter).setZero();
  // Any positive number: without coupling and gradient its step is zero.
  border_block(parameter, parameter) = 1;
  border_gradient(parameter) = 0;
  for (ChainBorderRows& rows : to_border) rows.col(parameter).setZero();
}

std::optional<ChainSolution> solveChain(const BlockArrow& system, const ChainOptions& options) {
  return Elimination(system, options).run();
}

std::optional<ChainInverse> invertChain(const BlockArrow& system, const ChainOptions& options) {
  Elimination elimination(system, options);
  auto solution = elimination.run();
  if (!solution) return std::nullopt;
  ChainInverse out{std::move(*solution), {}};
  out.covariance = elimination.covariance(out.solution.border_information);
  return out;
}

std::optional<std::vector<ChainResponse>> chainResponses(BlockArrow system, int threads) {
  const ChainOptions options{0, threads};
  Elimination elimination(system, options, &system);
  if (!elimination.eliminateAll()) return std::nullopt;
  return elimination.responses();
}

}  // namespace plumbline
