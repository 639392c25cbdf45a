// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to field_gram.cpp: the sums of gram_kernel.h with a misfit field's columns beside.
// Everything is always_inline, as there, but products of columns.

#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibrator/residuals/field_gram.h"
#include "calibrator/residuals/gram_kernel.h"

namespace plumbline::fields {

/// Combinations of the functions of u and v, or (no coefficients) each function by itself.
struct Combinations {
  const double* coefficients = nullptr;  ///< kFieldColumns x count, `stride` from column to column
  Eigen::Index stride = 0, count = kFieldColumns;
};

/// What the kernel reads besides gram::Input.
struct FieldInput {
  FieldBox box;
  bool squares = false;
  Combinations combinations;
};

/// (pixel - centre) / half, held to [-1, 1].
template <int W>
[[gnu::always_inline]] inline Lanes<W> clampedPlace(const Lanes<W>& pixel, double centre,
                                                    double half) {
  const Lanes<W> one = Lanes<W>{} + 1.0;
  const Lanes<W> x = (pixel - centre) / half;
  const Lanes<W> low = x < -one ? -one : x;
  return low > one ? one : low;
}

inline constexpr double kRootOf3 = 1.7320508075688772;

/// sqrt(2i+1) P_i(x) by the recurrence (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}.
template <int W>
[[gnu::always_inline]] inline void legendre(const Lanes<W>& x, Lanes<W> (&P)[kFieldDegree + 1]) {
  constexpr double kNorm[] = {1,   kRootOf3,          2.2360679774997897, 2.6457513110645906,
                              3.0, 3.3166247903553998};
  static_assert(std::size(kNorm) == kFieldDegree + 1);
  P[0] = Lanes<W>{} + 1.0;
  P[1] = x;
#pragma GCC unroll 8
  for (int k = 1; k < kFieldDegree; ++k) {
    P[k + 1] = ((2.0 * k + 1) / (k + 1)) * x * P[k] - (static_cast<double>(k) / (k + 1)) * P[k - 1];
  }
#pragma GCC unroll 8
  for (int k = 1; k <= kFieldDegree; ++k) P[k] *= kNorm[k];
}

/// Calls put(place, value) for each function.
template <int W, class Put>
[[gnu::always_inline]] inline void eachFunction(const FieldBox& box, const Lanes<W>& u,
                                                const Lanes<W>& v, const Put& put) {
  Lanes<W> X[kFieldDegree + 1];
  Lanes<W> Y[kFieldDegree + 1];
  legendre<W>(clampedPlace<W>(u, box.centre[0], box.half[0]), X);
  legendre<W>(clampedPlace<W>(v, box.centre[1], box.half[1]), Y);
  int place = 0;
#pragma GCC unroll 8
  for (int i = 0; i <= kFieldDegree; ++i) {
#pragma GCC unroll 8
    for (int j = 0; i + j <= kFieldDegree; ++j) put(place++, X[i] * Y[j]);
  }
  const double unit = 1 / box.half.norm();
  const Lanes<W> du = (X[1] * (box.half[0] / kRootOf3) + (box.centre[0] - box.axis[0])) * unit;
  const Lanes<W> dv = (Y[1] * (box.half[1] / kRootOf3) + (box.centre[1] - box.axis[1])) * unit;
  const Lanes<W> r2 = du * du + dv * dv;
  Lanes<W> power = r2 * r2;
#pragma GCC unroll 8
  for (int k = 0; k < kFieldRadials; ++k) {
    power *= r2;
    put(place++, du * power);
    put(place++, dv * power);
  }
}

template <int W, int S>
struct FieldSums {
  gram::Sums<W, S> view;
  /// Per row: (shared, e, m, 1) x functions; those of e only where squares are kept.
  Lanes<W> fields[2][S + 3][kFieldFunctions] = {};
  Lanes<W> squares[kFieldFunctions][kFieldFunctions];  // only where they are kept
};

/// Rows kRow .. kEnd - 1 of the left factor against all functions.
template <int W, int kEnd, int kRow = 0>
[[gnu::always_inline]] inline void addAgainst(const double* left, const double* functions, int n,
                                              Lanes<W>* sums) {
  constexpr int kRows = kEnd - kRow < 4 ? kEnd - kRow : 4;
  gram::Products<W>::template strip<kRows, kFieldFunctions>(
      left + kRow * gram::kStride, functions, n, sums + kRow * kFieldFunctions, kFieldFunctions);
  if constexpr (kRow + kRows < kEnd) addAgainst<W, kEnd, kRow + kRows>(left, functions, n, sums);
}

/// The corners of one group: the columns of the view, and the functions, all times the root of
/// the corner's weight: one set of columns is then both factors of every product. That is possible
/// because the weight is a scalar (re-weighted least squares), not the 2x2 one of viewGram().
template <int W, int S, class Model, bool kRobust>
[[gnu::always_inline]] inline void fillGroup(const gram::Input& in, const FieldBox& box, int first,
                                             int j, double* left, double* functions,
                                             Lanes<W>& invalid, Lanes<W>& squared) {
  auto g = gram::projectGroup<W, Model>(in, first + j, invalid);
  // g.squared holds one weight; the cost counts w^2, and no loss.
  squared += g.w * g.squared;
  if constexpr (kRobust) {
    const Lanes<W> slope = 1.0 / (1.0 + (g.e_u * g.e_u + g.e_v * g.e_v) * in.inverse_c2);
    for (int lane = 0; lane < W; ++lane) g.w[lane] *= std::sqrt(slope[lane]);
  }
  gram::fillPlain<W, S, true, false>(in, g, first + j, left + j);
  eachFunction<W>(box, load<W>(in.view.u + first + j), load<W>(in.view.v + first + j),
                  [&](int place, const Lanes<W>& f) {
                    store<W>(functions + place * gram::kStride + j, g.w * f);
                  });
}

/// Sums over a view as gram::sumView() has them, and against the functions beside. Rows u and v are
/// summed apart, for each has columns of its own in F.
template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void sumFields(
    const gram::Input& in, const FieldInput& f,
    FieldSums<W, gram::kShared<Model, true, false>>& sums) {
  using gram::kChunk;
  using gram::kStride;
  constexpr int S = gram::kShared<Model, true, false>;
  alignas(64) double left[(S + 3) * kStride];
  alignas(64) double functions[kFieldFunctions * kStride];
  if (f.squares) {
    for (auto& row : sums.squares) std::fill(std::begin(row), std::end(row), Lanes<W>{});
  }
  Lanes<W> invalid = {};
  for (int first = 0; first < in.view.padded; first += kChunk) {
    const int n = std::min(in.view.padded - first, kChunk);
    for (int j = 0; j < n; j += W) {
      fillGroup<W, S, Model, kRobust>(in, f.box, first, j, left, functions, invalid,
                                      sums.view.squared);
    }
    for (int row = 0; row < 2; ++row) {
      const double* half = left + row * kChunk;
      gram::Products<W>::template upper<S>(half, half, n, &sums.view.shared[0][0]);
      gram::Products<W>::template strip<2, S + 3>(half + (S + gram::kPlane) * kStride, half, n,
                                                  &sums.view.own[row][0][0], S + 3);
      Lanes<W>* fields = &sums.fields[row][0][0];
      addAgainst<W, S>(half, functions, n, fields);
      addAgainst<W, S + 3, S + gram::kPlane>(half, functions, n, fields);
      if (f.squares) addAgainst<W, S + gram::kPlane, S + gram::kError>(half, functions, n, fields);
    }
    if (f.squares) addAgainst<W, kFieldFunctions>(functions, functions, n, &sums.squares[0][0]);
  }
  // Unlike viewGram(), cost is squared_error whatever the loss.
  const double charged = kInvalidSquaredError * gram::sumOf<W>(invalid);
  sums.view.squared[0] += charged;
  sums.view.cost = gram::sumOf<W>(sums.view.squared);
}

/// One row's sums against each function, lanes added up: (shared, m, 1), up to whole lanes.
template <int W, int S>
struct RowSums {
  static constexpr int kSize = (S + 2 + W - 1) / W * W;
  alignas(64) double of[kFieldFunctions][kSize];

  [[gnu::always_inline]] RowSums(const FieldSums<W, S>& sums, int row) {
    double totals[S + 3][kFieldFunctions];
    gram::Products<W>::total(&sums.fields[row][0][0], (S + 3) * kFieldFunctions, &totals[0][0]);
    for (int f = 0; f < kFieldFunctions; ++f) {
      for (int i = 0; i < S; ++i) of[f][i] = totals[i][f];
      of[f][S] = totals[S + gram::kPlane][f];
      of[f][S + 1] = totals[S + gram::kOne][f];
      for (int i = S + 2; i < kSize; ++i) of[f][i] = 0;
    }
  }
};

/// Adds (shared, m, 1) of one row to a column of F. Rows of k in the order fu fv pu pv, shape: the
/// columns of u do not meet fv and pv, nor those of v fu and pu.
template <int kShape>
[[gnu::always_inline]] inline void addColumn(const double* sums, int row, Eigen::Index column,
                                             FieldGram& out) {
  for (int i = 0; i < 6; ++i) out.H_pose_f(i, column) += sums[i];
  for (int i = 0; i < kShape; ++i) out.H_k_f(4 + i, column) += sums[6 + i];
  out.H_k_f(row, column) += sums[6 + kShape];
  out.H_k_f(2 + row, column) += sums[6 + kShape + 1];
}

/// J combinations at once, from `first`: sums of a row times their coefficients.
template <int W, int kShape, int J>
[[gnu::always_inline]] inline void addCombined(const RowSums<W, 6 + kShape>& sums, int row,
                                               const Combinations& R, Eigen::Index first,
                                               FieldGram& out) {
  constexpr int kSize = RowSums<W, 6 + kShape>::kSize;
  const double* r = R.coefficients + first * R.stride + row * kFieldFunctions;
  Lanes<W> sum[J][kSize / W] = {};
  for (int f = 0; f < kFieldFunctions; ++f) {
#pragma GCC unroll 8
    for (int v = 0; v < kSize / W; ++v) {
      const Lanes<W> part = load<W>(sums.of[f] + v * W);
#pragma GCC unroll 4
      for (int j = 0; j < J; ++j) sum[j][v] += r[j * R.stride + f] * part;
    }
  }
  double column[kSize];
#pragma GCC unroll 4
  for (int j = 0; j < J; ++j) {
#pragma GCC unroll 8
    for (int v = 0; v < kSize / W; ++v) store<W>(column + v * W, sum[j][v]);
    addColumn<kShape>(column, row, first + j, out);
  }
}

template <int W, int kShape>
[[gnu::always_inline]] inline void writeFields(const FieldSums<W, 6 + kShape>& sums,
                                               const Combinations& R, FieldGram& out) {
  constexpr int kAtOnce = W;  // a dozen sums, of 16 registers on x86-64
  out.H_pose_f.setZero(6, R.count);
  out.H_k_f.setZero(4 + kShape, R.count);
  for (int row = 0; row < 2; ++row) {
    const RowSums<W, 6 + kShape> own(sums, row);
    if (R.coefficients == nullptr) {
      for (int f = 0; f < kFieldFunctions; ++f) {
        addColumn<kShape>(own.of[f], row, row * kFieldFunctions + f, out);
      }
      continue;
    }
    Eigen::Index k = 0;
    for (; k + kAtOnce <= R.count; k += kAtOnce) {
      addCombined<W, kShape, kAtOnce>(own, row, R, k, out);
    }
    for (; k < R.count; ++k) addCombined<W, kShape, 1>(own, row, R, k, out);
  }
}

template <int W, int S>
[[gnu::always_inline]] inline void writeSquares(const FieldSums<W, S>& sums, FieldGram& out) {
  for (int row = 0; row < 2; ++row) {
    gram::Products<W>::total(sums.fields[row][S + gram::kError], kFieldFunctions,
                             out.b_f.data() + row * kFieldFunctions);
  }
  // Symmetric: rows or columns first is the same.
  gram::Products<W>::total(&sums.squares[0][0], kFieldFunctions * kFieldFunctions, out.H_f.data());
}

template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void compute(const gram::Input& in, const FieldInput& f,
                                           FieldGram& out) {
  // Tens of kilobytes: filled in place, not copied.
  FieldSums<W, gram::kShared<Model, true, false>> sums;
  sumFields<W, Model, kRobust>(in, f, sums);
  // Sums of the u-v coupling stay zero: a scalar weight brings none.
  const auto view = gram::totalsOf(sums.view);
  gram::writePose(view, out);
  gram::writeIntrinsics<Model::kShape>(view, out);
  writeFields<W, Model::kShape>(sums, f.combinations, out);
  if (f.squares) {
    writeSquares<W>(sums, out);
  } else {
    out.H_f.setZero();
    out.b_f.setZero();
  }
}

}  // namespace plumbline::fields
