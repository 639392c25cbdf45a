// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to the Gram kernels: products of columns, tiled so that sums stay in registers.

#include "calibrator/camera/lanes.h"

#if defined(__x86_64__)
#define PLUMBLINE_AVX2 [[gnu::target("avx2,fma")]]
#else
#define PLUMBLINE_AVX2
#endif

namespace plumbline::gram {

/// Corners handled at a time: their columns stay in the first-level cache.
inline constexpr int kChunk = 48;
/// Numbers from one column to the next: a corner's row u in the first half, its row v in the
/// second.
inline constexpr int kStride = 2 * kChunk;

/// How many numbers fill a register that holds W doubles.
template <int W, class Scalar>
inline constexpr int kWidthOf = static_cast<int>(W * sizeof(double) / sizeof(Scalar));
template <int W, class Scalar>
using Register = Lanes<kWidthOf<W, Scalar>, Scalar>;

template <int W>
[[gnu::always_inline]] inline double sumOf(const Lanes<W>& a) {
  double sum = a[0];
  for (int i = 1; i < W; ++i) sum += a[i];
  return sum;
}

/// sum[i][j] += left column i . right column j over n entries, for I x J columns at once, in
/// registers of W doubles or twice as many of single precision. Columns begin where registers may.
template <int W, int I, int J, class Scalar>
[[gnu::always_inline]] inline void multiply(const Scalar* left, int left_stride,
                                            const Scalar* right, int right_stride, int n,
                                            Register<W, Scalar> (&sum)[I][J]) {
  constexpr int kWidth = kWidthOf<W, Scalar>;
  for (int k = 0; k < n; k += kWidth) {
    Register<W, Scalar> r[J];
#pragma GCC unroll 8
    for (int j = 0; j < J; ++j) r[j] = loadAligned<kWidth>(right + j * right_stride + k);
#pragma GCC unroll 8
    for (int i = 0; i < I; ++i) {
      const Register<W, Scalar> l = loadAligned<kWidth>(left + i * left_stride + k);
#pragma GCC unroll 8
      for (int j = 0; j < J; ++j) sum[i][j] += l * r[j];
    }
  }
}

/// multiply() of sums that lie `sums_stride` apart from row to row.
template <int W, int I, int J>
[[gnu::always_inline]] inline void addTile(const double* left, const double* right, int n,
                                           Lanes<W>* sums, int sums_stride) {
  Lanes<W> sum[I][J];
#pragma GCC unroll 8
  for (int i = 0; i < I; ++i) {
#pragma GCC unroll 8
    for (int j = 0; j < J; ++j) sum[i][j] = sums[i * sums_stride + j];
  }
  multiply<W, I, J, double>(left, kStride, right, kStride, n, sum);
#pragma GCC unroll 8
  for (int i = 0; i < I; ++i) {
#pragma GCC unroll 8
    for (int j = 0; j < J; ++j) sums[i * sums_stride + j] = sum[i][j];
  }
}

/// How many columns a tile of I rows has, so that its sums, a row's columns and one product fit 16
/// registers. Two doubles are SSE2, where a product overwrites a factor: wider tiles spill
/// their sums.
template <int W, int I>
inline constexpr int kTileColumns = I < 3 ? 5 : (W == 2 ? 2 : 3);

/// I rows against J columns, cut into tiles.
template <int W, int I, int J>
[[gnu::always_inline]] inline void addStrip(const double* left, const double* right, int n,
                                            Lanes<W>* sums, int sums_stride) {
  constexpr int kTile = kTileColumns<W, I>;
  if constexpr (J > kTile) {
    addTile<W, I, kTile>(left, right, n, sums, sums_stride);
    addStrip<W, I, J - kTile>(left, right + kTile * kStride, n, sums + kTile, sums_stride);
  } else {
    addTile<W, I, J>(left, right, n, sums, sums_stride);
  }
}

/// Rows kRow..S-1 against columns >= the first row of each strip, up to column S (the error): the
/// upper triangle and a little of the lower one. sums is S x (S + 1).
template <int W, int S, int kRow = 0>
[[gnu::always_inline]] inline void addUpper(const double* left, const double* right, int n,
                                            Lanes<W>* sums) {
  constexpr int kRows = S - kRow < 4 ? S - kRow : 4;
  addStrip<W, kRows, S + 1 - kRow>(left + kRow * kStride, right + kRow * kStride, n,
                                   sums + kRow * (S + 1) + kRow, S + 1);
  if constexpr (kRow + kRows < S) addUpper<W, S, kRow + kRows>(left, right, n, sums);
}

/// The products above as functions that are called, with W lanes: every model, loss and sum of as
/// many columns shares them. Unrolled into each of these they nearly doubled the time of compilers,
/// for no gain: a call serves a whole chunk.
template <int W>
struct Products;

template <>
struct Products<2> {
  template <int S>
  [[gnu::noinline]] static void upper(const double* left, const double* right, int n,
                                      Lanes<2>* sums) {
    addUpper<2, S>(left, right, n, sums);
  }
  template <int I, int J>
  [[gnu::noinline]] static void strip(const double* left, const double* right, int n,
                                      Lanes<2>* sums, int sums_stride) {
    addStrip<2, I, J>(left, right, n, sums, sums_stride);
  }
  /// Adds up the lanes of each sum.
  [[gnu::noinline]] static void total(const Lanes<2>* sums, int n, double* out) {
    for (int i = 0; i < n; ++i) out[i] = sumOf<2>(sums[i]);
  }
};

/// The same for AVX2: an instruction set is an attribute of a function, which no template chooses.
template <>
struct Products<4> {
  template <int S>
  PLUMBLINE_AVX2 [[gnu::noinline]] static void upper(const double* left, const double* right, int n,
                                                     Lanes<4>* sums) {
    addUpper<4, S>(left, right, n, sums);
  }
  template <int I, int J>
  PLUMBLINE_AVX2 [[gnu::noinline]] static void strip(const double* left, const double* right, int n,
                                                     Lanes<4>* sums, int sums_stride) {
    addStrip<4, I, J>(left, right, n, sums, sums_stride);
  }
  PLUMBLINE_AVX2 [[gnu::noinline]] static void total(const Lanes<4>* sums, int n, double* out) {
    for (int i = 0; i < n; ++i) out[i] = sumOf<4>(sums[i]);
  }
};

}  // namespace plumbline::gram
