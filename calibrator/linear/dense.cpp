// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/linear/dense.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

// Haswell is the first x86-64 with AVX2 and fused multiply-add; the loader chooses the clone.
#if defined(__x86_64__)
#define PLUMBLINE_CLONES [[gnu::target_clones("default", "arch=haswell")]]
#else
#define PLUMBLINE_CLONES
#endif

namespace plumbline {
namespace {

constexpr double kLeastPivot = 1e-13;  // of a matrix with unit diagonal: below lies rounding

/// The indices below `size` that are not in `keep`, ascending.
std::vector<int> others(const std::vector<int>& keep, Eigen::Index size) {
  std::vector<int> drop;
  for (int i = 0; i < size; ++i) {
    if (std::ranges::find(keep, i) == keep.end()) drop.push_back(i);
  }
  assert(static_cast<Eigen::Index>(keep.size() + drop.size()) == size);
  return drop;
}

/// (I, -K^T) noise (I, -K^T)^T of the parameters (kept, dropped).
Eigen::MatrixXd noiseKept(const Eigen::MatrixXd& noise, const std::vector<int>& keep,
                          const std::vector<int>& drop, const Eigen::MatrixXd& K) {
  const Eigen::MatrixXd across = noise(keep, drop) * K;
  const Eigen::MatrixXd dropped = noise(drop, drop);
  return Eigen::MatrixXd(noise(keep, keep)) - across - across.transpose() +
         K.transpose() * dropped * K;
}

/// kRowLanes doubles at once (GCC vector extension); halves where the machine has no more.
using Row [[gnu::vector_size(8 * kRowLanes)]] = double;

/// By memcpy, since rows of a matrix need not be aligned to a whole Row.
[[gnu::always_inline]] inline Row load(const double* from) {
  Row row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

[[gnu::always_inline]] inline void store(const Row& row, double* to) {
  std::memcpy(to, &row, sizeof row);
}

/// to -= factor * from, from column `first` on, rounded down to whole lanes: what stands to the
/// left of `first` in the same lanes is spoilt, and lies below the diagonal, where nobody reads.
[[gnu::always_inline]] inline void subtract(double factor, const double* from, double* to,
                                            int first, int columns) {
  for (int c = first / kRowLanes * kRowLanes; c < columns; c += kRowLanes) {
    store(load(to + c) - factor * load(from + c), to + c);
  }
}

[[gnu::always_inline]] inline void scale(double factor, double* row, int first, int columns) {
  for (int c = first / kRowLanes * kRowLanes; c < columns; c += kRowLanes) {
    store(factor * load(row + c), row + c);
  }
}

/// Right-looking Cholesky by rows: row j of (A | B) divided by the root of its pivot is row j of
/// (L' | L^-1 B), and its outer product is taken off all later rows, the coupled columns included.
PLUMBLINE_CLONES bool factorise(double* rows, int n, int columns) {
  for (int j = 0; j < n; ++j) {
    double* const row = rows + j * columns;
    const double pivot = row[j];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    scale(1 / std::sqrt(pivot), row, j, columns);
    for (int i = j + 1; i < n; ++i) subtract(row[i], row, rows + i * columns, i, columns);
  }
  return true;
}

/// Tiles of kRowLanes x kRowLanes that stay in registers while they sum over the rows.
PLUMBLINE_CLONES void addGramTiles(const double* P, int n, int stride, double* gram, int columns) {
  for (int r = 0; r < columns; r += kRowLanes) {
    for (int c = r; c < columns; c += kRowLanes) {
      Row tile[kRowLanes];
#pragma GCC unroll 4
      for (int q = 0; q < kRowLanes; ++q) tile[q] = load(gram + (r + q) * columns + c);
      for (int k = 0; k < n; ++k) {
        const double* const row = P + k * stride;
        const Row right = load(row + c);
#pragma GCC unroll 4
        for (int q = 0; q < kRowLanes; ++q) tile[q] += row[r + q] * right;
      }
#pragma GCC unroll 4
      for (int q = 0; q < kRowLanes; ++q) store(tile[q], gram + (r + q) * columns + c);
    }
  }
}

/// By rows of B, from the last: each solved row is taken off those above, so that all inner loops
/// run along rows.
PLUMBLINE_CLONES void backSubstitute(const double* U, int n, int stride, double* B, int columns) {
  for (int i = n - 1; i >= 0; --i) {
    double* const row = B + i * columns;
    scale(1 / U[i * stride + i], row, 0, columns);
    for (int k = 0; k < i; ++k) subtract(U[k * stride + i], row, B + k * columns, 0, columns);
  }
}

/// One row of A B.
PLUMBLINE_CLONES void multiply(const double* a, int n, const double* B, int columns, double* out) {
  for (int c = 0; c < columns; c += kRowLanes) {
    Row sum = {};
    for (int k = 0; k < n; ++k) sum += a[k] * load(B + k * columns + c);
    store(sum, out + c);
  }
}

int count(Eigen::Index n) { return static_cast<int>(n); }

}  // namespace

bool factoriseRows(RowMatrix& rows) {
  assert(rows.cols() % kRowLanes == 0);
  return factorise(rows.data(), count(rows.rows()), count(rows.cols()));
}

void addGram(const RowMatrix& rows, int first, RowMatrix& gram) {
  assert(first % kRowLanes == 0 && rows.cols() % kRowLanes == 0 &&
         gram.cols() == rows.cols() - first);
  addGramTiles(rows.data() + first, count(rows.rows()), count(rows.cols()), gram.data(),
               count(gram.cols()));
}

RowMatrix solveUpper(const RowMatrix& rows, RowMatrix B) {
  assert(B.cols() % kRowLanes == 0 && B.rows() == rows.rows());
  backSubstitute(rows.data(), count(B.rows()), count(rows.cols()), B.data(), count(B.cols()));
  return B;
}

RowMatrix product(const RowMatrix& A, const RowMatrix& B) {
  assert(B.cols() % kRowLanes == 0 && A.cols() == B.rows());
  RowMatrix out(A.rows(), B.cols());
  for (Eigen::Index r = 0; r < A.rows(); ++r) {
    multiply(&A(r, 0), count(A.cols()), B.data(), count(B.cols()), &out(r, 0));
  }
  return out;
}

QuadraticCost QuadraticCost::at(const Eigen::VectorXd& d) const {
  assert(d.size() == b.size());
  const Eigen::VectorXd Hd = H * d;
  return {H, b + Hd, c + d.dot(b) + 0.5 * d.dot(Hd), noise};
}

QuadraticCost QuadraticCost::through(const Eigen::MatrixXd& J) const {
  // The curvature of the change of coordinates, which b would multiply, is left out (Gauss-Newton).
  QuadraticCost out{J.transpose() * H * J, J.transpose() * b, c};
  if (noise.size() > 0) out.noise = J.transpose() * noise * J;
  return out;
}

std::optional<ScaledCholesky> scaledCholesky(const Eigen::MatrixXd& A) {
  assert(A.rows() == A.cols());
  if (!(A.diagonal().array() > 0).all()) return std::nullopt;
  ScaledCholesky f;
  f.D = A.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = f.D.cwiseInverse();
  f.llt.compute(inverse.asDiagonal() * A * inverse.asDiagonal());
  if (f.llt.info() != Eigen::Success) return std::nullopt;
  // With a unit diagonal the pivot of parameter j is 1 - R^2 of its regression on those before it.
  if (!(f.llt.matrixLLT().diagonal().array().square() >= kLeastPivot).all()) return std::nullopt;
  return f;
}

std::optional<QuadraticCost> marginalised(const QuadraticCost& cost, const std::vector<int>& keep) {
  assert(cost.H.rows() == cost.H.cols() && cost.H.rows() == cost.b.size());
  const std::vector<int> drop = others(keep, cost.b.size());
  const bool noisy = cost.noise.size() > 0;
  QuadraticCost out{cost.H(keep, keep), cost.b(keep), cost.c};
  if (noisy) out.noise = cost.noise(keep, keep);
  if (drop.empty()) return out;
  const auto factor = scaledCholesky(cost.H(drop, drop));
  if (!factor) return std::nullopt;
  const Eigen::VectorXd scale = factor->D.cwiseInverse();
  // W = L^-1 H_dk and y = L^-1 b_d: products with their transposes are symmetric to the last bit.
  Eigen::MatrixXd W = scale.asDiagonal() * cost.H(drop, keep);
  Eigen::VectorXd y = scale.asDiagonal() * cost.b(drop);
  factor->llt.matrixL().solveInPlace(W);
  factor->llt.matrixL().solveInPlace(y);
  out.H.triangularView<Eigen::Lower>() -= W.transpose() * W;
  out.H.triangularView<Eigen::StrictlyUpper>() = out.H.transpose();
  out.b -= W.transpose() * y;
  out.c -= 0.5 * y.squaredNorm();
  if (noisy) {
    factor->llt.matrixU().solveInPlace(W);
    const Eigen::MatrixXd K = scale.asDiagonal() * W;  // H_dd^-1 H_dk
    out.noise = noiseKept(cost.noise, keep, drop, K);
  }
  return out;
}

}  // namespace plumbline
