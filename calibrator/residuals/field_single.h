// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to field_gram.cpp: a view's columns against a misfit field's functions in single
// precision, always inlined as gram_kernel.h says.

#include <cstring>

#include "calibrator/residuals/field_functions.h"
#include "calibrator/residuals/gram_kernel.h"

namespace plumbline::fields {

/// Columns of the view, (shared, e, m, 1), at n corners whose pixels are u, v: all times the root
/// of the corner's weight. One set of columns is then both factors of every product, which is
/// possible because the weight is a scalar (re-weighted least squares), not the 2x2 one of
/// viewGram().
struct Columns {
  const double* left;
  const double* u;
  const double* v;
  int n;
};

/// One row's sums against each function, lanes added up: (shared, m, 1), up to whole registers.
template <int S, class Scalar>
struct RowSums {
  static constexpr int kSize = (S + 2 + 3) / 4 * 4;
  alignas(64) Scalar of[kFieldFunctions][kSize];
};

/// Where squares are not kept, products with the functions are summed in single precision: they are
/// three quarters of all products, and of them as many more fit a register. They weigh a misfit
/// whose size is an estimate from residuals; 6 digits serve it. Columns of many corners are
/// collected before they are multiplied, so that no sum leaves its register.
template <int S>
struct SingleSums {
  static constexpr int kBlock = 3 * gram::kChunk;
  RowSums<S, float> rows[2];
  /// Of `count` corners: (shared, m, 1), row u and row v of a column; their places in the box.
  static constexpr int kColumns = RowSums<S, float>::kSize;
  alignas(64) float left[kColumns][2][kBlock];
  alignas(64) float place[2][kBlock];
  int count = 0;

  void clear() {
    for (auto& row : rows) std::memset(row.of, 0, sizeof row.of);
    // Columns that only fill a register.
    for (int i = S + 2; i < kColumns; ++i) std::memset(left[i], 0, sizeof left[i]);
  }
};

template <int W>
[[gnu::always_inline]] inline void storeSingle(float* to, const Lanes<W>& a) {
  store<W>(to, __builtin_convertvector(a, Lanes<W, float>));
}

/// Collects the columns of a chunk.
template <int W, int S>
[[gnu::always_inline]] inline void collect(const FieldBox& box, const Columns& in,
                                           SingleSums<S>& sums) {
  for (int i = 0; i < S + 2; ++i) {
    const int column = i < S ? i : i + gram::kPlane;  // without the error
    for (int row = 0; row < 2; ++row) {
      const double* from = in.left + column * gram::kStride + row * gram::kChunk;
      float* to = sums.left[i][row] + sums.count;
      for (int j = 0; j < in.n; j += W) storeSingle<W>(to + j, load<W>(from + j));
    }
  }
  for (int j = 0; j < in.n; j += W) {
    const int at = sums.count + j;
    storeSingle<W>(sums.place[0] + at,
                   clampedPlace<W>(load<W>(in.u + j), box.centre[0], box.half[0]));
    storeSingle<W>(sums.place[1] + at,
                   clampedPlace<W>(load<W>(in.v + j), box.centre[1], box.half[1]));
  }
  sums.count += in.n;
}

/// Adds the lanes of each of four registers: the sum of a[i] at i.
template <int W>
[[gnu::always_inline]] inline Lanes<4, float> sumsOfFour(const gram::Register<W, float> (&a)[4]) {
  Lanes<4, float> half[4];
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    if constexpr (W == 2) {
      half[i] = a[i];
    } else {
      half[i] = __builtin_shufflevector(a[i], a[i], 0, 1, 2, 3) +
                __builtin_shufflevector(a[i], a[i], 4, 5, 6, 7);
    }
  }
  // Lanes 0 and 2 of two registers beside lanes 1 and 3 of them, twice.
  const auto ab = __builtin_shufflevector(half[0], half[1], 0, 4, 1, 5) +
                  __builtin_shufflevector(half[0], half[1], 2, 6, 3, 7);
  const auto cd = __builtin_shufflevector(half[2], half[3], 0, 4, 1, 5) +
                  __builtin_shufflevector(half[2], half[3], 2, 6, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// Four columns from `left` on against functions kFirst to the last.
template <int W, int S, int kFirst = 0>
[[gnu::always_inline]] inline void addFour(const float* left, const float* functions, int n, int at,
                                           RowSums<S, float>& sums) {
  constexpr int kMost = gram::kTileColumns<W, 4>;
  constexpr int kTile = kFieldFunctions - kFirst < kMost ? kFieldFunctions - kFirst : kMost;
  constexpr int kBlock = SingleSums<S>::kBlock;
  gram::Register<W, float> sum[4][kTile] = {};
  gram::multiply<W, 4, kTile, float>(left, 2 * kBlock, functions + kFirst * kBlock, kBlock, n, sum);
#pragma GCC unroll 4
  for (int j = 0; j < kTile; ++j) {
    const gram::Register<W, float> column[4] = {sum[0][j], sum[1][j], sum[2][j], sum[3][j]};
    float* to = sums.of[kFirst + j] + at;
    const Lanes<4, float> all = load<4>(to) + sumsOfFour<W>(column);
    store<4>(to, all);
  }
  if constexpr (kFirst + kTile < kFieldFunctions) {
    addFour<W, S, kFirst + kTile>(left, functions, n, at, sums);
  }
}

/// Multiplies what was collected.
template <int W, int S>
[[gnu::always_inline]] inline void flush(const FieldBox& box, SingleSums<S>& sums) {
  constexpr int kBlock = SingleSums<S>::kBlock;
  constexpr int kWide = gram::kWidthOf<W, float>;
  static_assert(kLanes % kWide == 0, "padding fills registers");
  alignas(64) float functions[kFieldFunctions * kBlock];
  for (int j = 0; j < sums.count; j += kWide) {
    const auto w = load<kWide>(sums.left[S + 1][0] + j);
    eachFunction<kWide, float>(box, load<kWide>(sums.place[0] + j), load<kWide>(sums.place[1] + j),
                               [&](int number, const Lanes<kWide, float>& f) {
                                 store<kWide>(functions + number * kBlock + j, w * f);
                               });
  }
  for (int row = 0; row < 2; ++row) {
    for (int i = 0; i < sums.kColumns; i += 4) {
      addFour<W, S>(sums.left[i][row], functions, sums.count, i, sums.rows[row]);
    }
  }
  sums.count = 0;
}

}  // namespace plumbline::fields
