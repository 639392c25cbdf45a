// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to predicted_error.cpp: E of one set of views, W lanes at a time. Everything is
// always_inline, so that the function into which it is inlined decides on the instruction set.

#include <Eigen/Core>
#include <cstring>
#include <limits>
#include <vector>

#include "calibrator/camera/lanes.h"

namespace plumbline::excess {

constexpr int wholeLanes(Eigen::Index n) { return static_cast<int>((n + 3) / 4 * 4); }

/// Symmetric matrices H and Q, and the rows [L | C] that are solved for, each part of a row padded
/// with zeros to whole lanes. L is lower triangular. Rows of H are read from the diagonal on, rows
/// of Q up to it.
class Rows {
 public:
  Rows(const Eigen::MatrixXd& H, const Eigen::MatrixXd& L, const Eigen::MatrixXd& C)
      : n(static_cast<int>(H.rows())),
        side(wholeLanes(n)),
        fields(wholeLanes(C.cols())),
        stride(2 * side + fields),
        inverse_pivot(n),
        values_(n * stride, 0.0) {
    for (int i = 0; i < n; ++i) {
      std::memcpy(H_of(i), H.col(i).data(), n * sizeof(double));
      for (int j = 0; j <= i; ++j) L_of(i)[j] = L(i, j);
      for (int j = 0; j < C.cols(); ++j) C_of(i)[j] = C(i, j);
    }
  }
  double* H_of(int i) { return values_.data() + i * stride; }
  double* L_of(int i) { return H_of(i) + side; }
  double* C_of(int i) { return L_of(i) + side; }

  const int n, side, fields, stride;
  std::vector<double> inverse_pivot;  ///< n of them, once eliminated

 private:
  std::vector<double> values_;
};

/// to += factor from, over entries begin .. end - 1.
template <int W>
[[gnu::always_inline]] inline void add(double factor, const double* from, int begin, int end,
                                       double* to) {
  for (int j = begin; j < end; j += W) {
    const Lanes<W> sum = load<W>(to + j) + factor * load<W>(from + j);
    store<W>(to + j, sum);
  }
}

/// to = scale (to + sum of factor(k) row(k) over k = first .. end - 1), `size` entries; each group
/// of lanes through all rows before the next, so that its sum stays in a register.
template <int W, class Factor, class Row>
[[gnu::always_inline]] inline void addRows(int first, int end, const Factor& factor, const Row& row,
                                           double scale, int size, double* to) {
  for (int j = 0; j < size; j += W) {
    Lanes<W> sum = load<W>(to + j);
    for (int k = first; k < end; ++k) sum += factor(k) * load<W>(row(k) + j);
    sum *= scale;
    store<W>(to + j, sum);
  }
}

template <int W>
[[gnu::always_inline]] inline double dot(const double* a, const double* b, int end) {
  Lanes<W> sum = {};
  for (int j = 0; j < end; j += W) sum += load<W>(a + j) * load<W>(b + j);
  double all = sum[0];
  for (int i = 1; i < W; ++i) all += sum[i];
  return all;
}

/// H = U^T D^-1 U by rows of U, whose diagonal is D: H becomes U, and L and C what D U^-T makes of
/// them. False where a pivot is not positive. Row i of L keeps its zeros beyond column i.
template <int W>
[[gnu::always_inline]] inline bool eliminate(Rows& rows) {
  for (int k = 0; k < rows.n; ++k) {
    const double* H = rows.H_of(k);
    if (!(H[k] > 0)) return false;
    const double inverse = 1 / H[k];
    rows.inverse_pivot[k] = inverse;
    for (int i = k + 1; i < rows.n; ++i) {
      const double factor = -H[i] * inverse;
      add<W>(factor, H, i / W * W, rows.side, rows.H_of(i));
      add<W>(factor, rows.L_of(k), 0, k + 1, rows.L_of(i));
      add<W>(factor, rows.C_of(k), 0, rows.fields, rows.C_of(i));
    }
  }
  return true;
}

/// |(L^T H^-1 C - bias) S|^2 of what eliminate() left; `spread` is S^T.
template <int W>
[[gnu::always_inline]] inline double squaredBias(Rows& rows, const Eigen::MatrixXd& bias,
                                                 const Eigen::MatrixXd& spread) {
  std::vector<double> row(rows.fields);
  std::vector<double> image(rows.fields);
  double sum = 0;
  for (int i = 0; i < rows.n; ++i) {
    row.assign(row.size(), 0.0);
    for (int j = 0; j < bias.cols(); ++j) row[j] = -bias(i, j);
    addRows<W>(
        i, rows.n, [&](int k) { return rows.L_of(k)[i] * rows.inverse_pivot[k]; },
        [&](int k) { return rows.C_of(k); }, 1, rows.fields, row.data());
    image.assign(image.size(), 0.0);
    addRows<W>(
        0, static_cast<int>(spread.cols()), [&](int k) { return row[k]; },
        [&](int k) { return spread.col(k).data(); }, 1, rows.fields, image.data());
    sum += dot<W>(image.data(), image.data(), rows.fields);
  }
  return sum;
}

/// L becomes Z = H^-1 L.
template <int W>
[[gnu::always_inline]] inline void substituteBack(Rows& rows) {
  for (int i = rows.n - 1; i >= 0; --i) {
    const double* H = rows.H_of(i);
    double* z = rows.L_of(i);
    addRows<W>(
        i + 1, rows.n, [&](int k) { return -H[k]; }, [&](int k) { return rows.L_of(k); },
        rows.inverse_pivot[i], rows.side, z);
  }
}

/// <Q, Z Z^T> of Z in the place of L.
template <int W>
[[gnu::always_inline]] inline double traceOfProduct(Rows& rows, const Eigen::MatrixXd& Q) {
  std::vector<double> row(rows.side);
  double sum = 0;
  for (int i = 0; i < rows.n; ++i) {
    row.assign(row.size(), 0.0);
    // The lower triangle twice.
    addRows<W>(
        0, i + 1, [&](int j) { return j < i ? 2 * Q(i, j) : Q(i, i); },
        [&](int j) { return rows.L_of(j); }, 1, rows.side, row.data());
    sum += dot<W>(row.data(), rows.L_of(i), rows.side);
  }
  return sum;
}

/// What E is made of; see PredictedError.
struct Input {
  const Eigen::MatrixXd &H, &C, &Q, &L, &bias;  ///< of Q the lower triangle is read
  const Eigen::MatrixXd& spread;  ///< S^T, its rows padded with zeros to whole lanes; or empty
  double sigma2, tau2;
};

/// With Z = H^-1 L and P = Z Z^T = H^-1 H_T H^-1:
///   E = sigma^2 tr(L^T H^-1 L) + tau^2 <Q, P> + |(L^T H^-1 C - L^T A_T) S|^2.
template <int W>
[[gnu::always_inline]] inline double value(const Input& in) {
  Rows rows(in.H, in.L, in.C);
  if (!eliminate<W>(rows)) return std::numeric_limits<double>::infinity();
  double variance = 0;
  for (int k = 0; k < rows.n; ++k) {
    variance += dot<W>(rows.L_of(k), rows.L_of(k), k + 1) * rows.inverse_pivot[k];
  }
  double E = in.sigma2 * variance;
  if (in.spread.size() > 0) E += squaredBias<W>(rows, in.bias, in.spread);
  if (in.tau2 > 0) {
    substituteBack<W>(rows);
    E += in.tau2 * traceOfProduct<W>(rows, in.Q);
  }
  return E;
}

}  // namespace plumbline::excess
