// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to field_gram.cpp: the sums of gram_kernel.h with a misfit field's columns beside.
// Everything is always_inline, as there, but products of columns.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "calibrator/residuals/field_functions.h"
#include "calibrator/residuals/field_single.h"
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

/// Products of the view's columns (shared, e, m, 1) with the functions, per row, and of the
/// functions with one another.
template <int W, int S>
struct ExactSums {
  Lanes<W> fields[2][S + 3][kFieldFunctions];
  Lanes<W> squares[kFieldFunctions][kFieldFunctions];

  void clear() {
    std::memset(fields, 0, sizeof fields);
    std::memset(squares, 0, sizeof squares);
  }
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

/// Rows u and v are summed apart, for each has columns of its own in F.
template <int W, int S>
[[gnu::always_inline]] inline void addExact(const FieldBox& box, const Columns& in,
                                            ExactSums<W, S>& sums) {
  using gram::kStride;
  alignas(64) double functions[kFieldFunctions * kStride];
  for (int j = 0; j < in.n; j += W) {
    const Lanes<W> x = clampedPlace<W>(load<W>(in.u + j), box.centre[0], box.half[0]);
    const Lanes<W> y = clampedPlace<W>(load<W>(in.v + j), box.centre[1], box.half[1]);
    const Lanes<W> w = load<W>(in.left + (S + gram::kOne) * kStride + j);
    eachFunction<W, double>(box, x, y, [&](int number, const Lanes<W>& f) {
      store<W>(functions + number * kStride + j, w * f);
    });
  }
  for (int row = 0; row < 2; ++row) {
    addAgainst<W, S + 3>(in.left + row * gram::kChunk, functions, in.n, &sums.fields[row][0][0]);
  }
  addAgainst<W, kFieldFunctions>(functions, functions, in.n, &sums.squares[0][0]);
}

template <int W, int S>
[[gnu::always_inline]] inline RowSums<S, double> rowSums(const ExactSums<W, S>& sums, int row) {
  RowSums<S, double> out;
  double totals[S + 3][kFieldFunctions];
  gram::Products<W>::total(&sums.fields[row][0][0], (S + 3) * kFieldFunctions, &totals[0][0]);
  for (int f = 0; f < kFieldFunctions; ++f) {
    for (int i = 0; i < S; ++i) out.of[f][i] = totals[i][f];
    out.of[f][S] = totals[S + gram::kPlane][f];
    out.of[f][S + 1] = totals[S + gram::kOne][f];
    for (int i = S + 2; i < out.kSize; ++i) out.of[f][i] = 0;
  }
  return out;
}

/// Adds (shared, m, 1) of one row to a column of F. Rows of k in the order fu fv pu pv, shape: the
/// columns of u do not meet fv and pv, nor those of v fu and pu.
template <int kShape, class Scalar>
[[gnu::always_inline]] inline void addColumn(const Scalar* sums, int row, Eigen::Index column,
                                             FieldGram& out) {
  for (int i = 0; i < 6; ++i) out.H_pose_f(i, column) += sums[i];
  for (int i = 0; i < kShape; ++i) out.H_k_f(4 + i, column) += sums[6 + i];
  out.H_k_f(row, column) += sums[6 + kShape];
  out.H_k_f(2 + row, column) += sums[6 + kShape + 1];
}

/// J combinations at once, from `first`: sums of a row times their coefficients.
template <int W, int kShape, int J, class Scalar>
[[gnu::always_inline]] inline void addCombined(const RowSums<6 + kShape, Scalar>& sums, int row,
                                               const Combinations& R, Eigen::Index first,
                                               FieldGram& out) {
  // In single precision four at a time, whatever the registers: they divide all sizes.
  constexpr int kWidth = sizeof(Scalar) == sizeof(float) ? 4 : W;
  constexpr int kSize = RowSums<6 + kShape, Scalar>::kSize;
  constexpr int kParts = kSize / kWidth;
  const double* r = R.coefficients + first * R.stride + row * kFieldFunctions;
  Lanes<kWidth, Scalar> sum[J][kParts] = {};
  for (int f = 0; f < kFieldFunctions; ++f) {
#pragma GCC unroll 8
    for (int v = 0; v < kParts; ++v) {
      const Lanes<kWidth, Scalar> part = load<kWidth>(sums.of[f] + v * kWidth);
#pragma GCC unroll 4
      for (int j = 0; j < J; ++j) sum[j][v] += static_cast<Scalar>(r[j * R.stride + f]) * part;
    }
  }
  Scalar column[kSize];
#pragma GCC unroll 4
  for (int j = 0; j < J; ++j) {
#pragma GCC unroll 8
    for (int v = 0; v < kParts; ++v) store<kWidth>(column + v * kWidth, sum[j][v]);
    addColumn<kShape>(column, row, first + j, out);
  }
}

template <int W, int kShape, class Scalar>
[[gnu::always_inline]] inline void writeRow(const RowSums<6 + kShape, Scalar>& sums, int row,
                                            const Combinations& R, FieldGram& out) {
  constexpr int kAtOnce = W;  // a dozen sums, of 16 registers on x86-64
  if (R.coefficients == nullptr) {
    for (int f = 0; f < kFieldFunctions; ++f) {
      addColumn<kShape>(sums.of[f], row, row * kFieldFunctions + f, out);
    }
    return;
  }
  Eigen::Index k = 0;
  for (; k + kAtOnce <= R.count; k += kAtOnce) {
    addCombined<W, kShape, kAtOnce>(sums, row, R, k, out);
  }
  for (; k < R.count; ++k) addCombined<W, kShape, 1>(sums, row, R, k, out);
}

template <int W, int kShape>
[[gnu::always_inline]] inline void writeExact(const ExactSums<W, 6 + kShape>& sums,
                                              const Combinations& R, FieldGram& out) {
  for (int row = 0; row < 2; ++row) {
    writeRow<W, kShape>(rowSums(sums, row), row, R, out);
    gram::Products<W>::total(sums.fields[row][6 + kShape + gram::kError], kFieldFunctions,
                             out.b_f.data() + row * kFieldFunctions);
  }
  // Symmetric: rows or columns first is the same.
  gram::Products<W>::total(&sums.squares[0][0], kFieldFunctions * kFieldFunctions, out.H_f.data());
}

template <int W, int kShape>
[[gnu::always_inline]] inline void writeSingle(const FieldBox& box, SingleSums<6 + kShape>& sums,
                                               const Combinations& R, FieldGram& out) {
  out.H_f.setZero();
  out.b_f.setZero();
  flush<W>(box, sums);
  for (int row = 0; row < 2; ++row) writeRow<W, kShape>(sums.rows[row], row, R, out);
}

/// What does not depend on the model but for how many columns it has, as functions that all models
/// share, like Products.
template <int W>
struct Fields;

template <>
struct Fields<2> {
  template <int S>
  [[gnu::noinline]] static void add(const FieldBox& box, const Columns& in, ExactSums<2, S>& sums) {
    addExact<2, S>(box, in, sums);
  }
  template <int S>
  [[gnu::noinline]] static void add(const FieldBox& box, const Columns& in, SingleSums<S>& sums) {
    if (sums.count + in.n > sums.kBlock) flush<2>(box, sums);
    collect<2>(box, in, sums);
  }
  template <int kShape>
  [[gnu::noinline]] static void write(const FieldInput& f, const ExactSums<2, 6 + kShape>& sums,
                                      FieldGram& out) {
    writeExact<2, kShape>(sums, f.combinations, out);
  }
  template <int kShape>
  [[gnu::noinline]] static void write(const FieldInput& f, SingleSums<6 + kShape>& sums,
                                      FieldGram& out) {
    writeSingle<2, kShape>(f.box, sums, f.combinations, out);
  }
};

template <>
struct Fields<4> {
  template <int S>
  PLUMBLINE_AVX2 [[gnu::noinline]] static void add(const FieldBox& box, const Columns& in,
                                                   ExactSums<4, S>& sums) {
    addExact<4, S>(box, in, sums);
  }
  template <int S>
  PLUMBLINE_AVX2 [[gnu::noinline]] static void add(const FieldBox& box, const Columns& in,
                                                   SingleSums<S>& sums) {
    if (sums.count + in.n > sums.kBlock) flush<4>(box, sums);
    collect<4>(box, in, sums);
  }
  template <int kShape>
  PLUMBLINE_AVX2 [[gnu::noinline]] static void write(const FieldInput& f,
                                                     const ExactSums<4, 6 + kShape>& sums,
                                                     FieldGram& out) {
    writeExact<4, kShape>(sums, f.combinations, out);
  }
  template <int kShape>
  PLUMBLINE_AVX2 [[gnu::noinline]] static void write(const FieldInput& f,
                                                     SingleSums<6 + kShape>& sums, FieldGram& out) {
    writeSingle<4, kShape>(f.box, sums, f.combinations, out);
  }
};

/// The view's columns of one group of corners.
template <int W, int S, class Model, bool kRobust>
[[gnu::always_inline]] inline void fillGroup(const gram::Input& in, int first, int j, double* left,
                                             Lanes<W>& invalid, Lanes<W>& squared) {
  auto g = gram::projectGroup<W, Model>(in, first + j, invalid);
  // g.squared holds one weight; the cost counts w^2, and no loss.
  squared += g.w * g.squared;
  if constexpr (kRobust) {
    const Lanes<W> slope = 1.0 / (1.0 + (g.e_u * g.e_u + g.e_v * g.e_v) * in.inverse_c2);
    for (int lane = 0; lane < W; ++lane) g.w[lane] *= std::sqrt(slope[lane]);
  }
  gram::fillPlain<W, S, true, false>(in, g, first + j, left + j);
}

/// Sums over a view as gram::sumView() has them, and against the functions beside.
template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void compute(const gram::Input& in, const FieldInput& f,
                                           FieldGram& out) {
  using gram::kChunk;
  using gram::kStride;
  constexpr int S = gram::kShared<Model, true, false>;
  alignas(64) double left[(S + 3) * kStride];
  gram::Sums<W, S> view;
  // One of both is used, the other costs nothing.
  ExactSums<W, S> exact;
  SingleSums<S> single;
  f.squares ? exact.clear() : single.clear();
  Lanes<W> invalid = {};
  for (int first = 0; first < in.view.padded; first += kChunk) {
    const int n = std::min(in.view.padded - first, kChunk);
    for (int j = 0; j < n; j += W) {
      fillGroup<W, S, Model, kRobust>(in, first, j, left, invalid, view.squared);
    }
    for (int row = 0; row < 2; ++row) {
      const double* half = left + row * kChunk;
      gram::Products<W>::template upper<S>(half, half, n, &view.shared[0][0]);
      gram::Products<W>::template strip<2, S + 3>(half + (S + gram::kPlane) * kStride, half, n,
                                                  &view.own[row][0][0], S + 3);
    }
    const Columns columns{left, in.view.u + first, in.view.v + first, n};
    f.squares ? Fields<W>::add(f.box, columns, exact) : Fields<W>::add(f.box, columns, single);
  }
  // Unlike viewGram(), cost is squared_error whatever the loss.
  view.squared[0] += kInvalidSquaredError * gram::sumOf<W>(invalid);
  view.cost = gram::sumOf<W>(view.squared);
  // Sums of the u-v coupling stay zero: a scalar weight brings none.
  const auto totals = gram::totalsOf(view);
  gram::writePose(totals, out);
  gram::writeIntrinsics<Model::kShape>(totals, out);
  out.H_pose_f.setZero(6, f.combinations.count);
  out.H_k_f.setZero(4 + Model::kShape, f.combinations.count);
  f.squares ? Fields<W>::template write<Model::kShape>(f, exact, out)
            : Fields<W>::template write<Model::kShape>(f, single, out);
}

}  // namespace plumbline::fields
