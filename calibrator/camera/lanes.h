// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <type_traits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace plumbline {

template <int kWidth, class Scalar>
struct LanesOf {
  using type [[gnu::vector_size(sizeof(Scalar) * kWidth)]] = Scalar;
};

/// kWidth numbers handled at once (GCC vector extension: + - * / < and ?: work per lane). The same
/// source serves every instruction set; the function into which it is inlined decides.
template <int kWidth, class Scalar = double>
using Lanes = typename LanesOf<kWidth, Scalar>::type;

/// W numbers in a row, at any address.
template <int W, class Scalar>
[[gnu::always_inline]] inline Lanes<W, Scalar> load(const Scalar* from) {
  Lanes<W, Scalar> a;
  __builtin_memcpy(&a, from, sizeof a);
  return a;
}

/// The same at an address aligned to their size, which SSE2 multiplies by without a load before.
template <int W, class Scalar>
[[gnu::always_inline]] inline Lanes<W, Scalar> loadAligned(const Scalar* from) {
  return load<W>(
      static_cast<const Scalar*>(__builtin_assume_aligned(from, sizeof(Lanes<W, Scalar>))));
}

template <int W, class Scalar>
[[gnu::always_inline]] inline void store(Scalar* to, const Lanes<W, Scalar>& a) {
  __builtin_memcpy(to, &a, sizeof a);
}

template <class T>
inline constexpr bool kIsLanes = !std::is_class_v<T> && !std::is_arithmetic_v<T>;

/// Square root per lane. For other arithmetic the usual sqrt, found by its arguments.
template <class T>
[[gnu::always_inline]] inline T squareRoot(const T& a) {
  if constexpr (kIsLanes<T>) {
    constexpr int kWidth = sizeof(T) / sizeof(double);
    T root;
#if defined(__SSE2__)
    // Pairs, which every x86-64 has: wider instructions may not be named in portable code.
    static_assert(kWidth % 2 == 0);
#pragma GCC unroll 4
    for (int i = 0; i < kWidth; i += 2) {
      const __m128d pair = _mm_sqrt_pd(_mm_set_pd(a[i + 1], a[i]));
      root[i] = pair[0];
      root[i + 1] = pair[1];
    }
#else
    for (int i = 0; i < kWidth; ++i) root[i] = __builtin_sqrt(a[i]);
#endif
    return root;
  } else {
    using std::sqrt;
    return sqrt(a);
  }
}

/// Arc tangent of a >= 0 per lane, within 2 units of the last place.
///
/// Range reduction to |a| <= tan(pi/8) (1/a above tan(3 pi/8), (a-1)/(a+1) in between), then the
/// rational approximation published with the Cephes library (S. Moshier, atan.c).
template <class T>
[[gnu::always_inline]] inline T arcTangentLanes(const T& a) {
  constexpr double kTan3Pi8 = 2.41421356237309504880;
  constexpr double kMiddle = 0.66;
  constexpr double kHalfPi = 1.57079632679489661923;
  constexpr double kHalfPiLow = 6.123233995736765886e-17;  // pi/2 - kHalfPi
  const auto high = a > kTan3Pi8;
  const auto middle = a > kMiddle;
  const T zero = a - a;
  const T one = zero + 1.0;
  const T numerator = high ? -one : (middle ? a - 1.0 : a);
  const T denominator = high ? a : (middle ? a + 1.0 : one);
  const T x = numerator / denominator;
  const T base = high ? zero + kHalfPi : (middle ? zero + 0.5 * kHalfPi : zero);
  const T low = high ? zero + kHalfPiLow : (middle ? zero + 0.5 * kHalfPiLow : zero);
  const T z = x * x;
  const T p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z -
                7.500855792314704667340e1) *
                   z -
               1.228866684490136173410e2) *
                  z -
              6.485021904942025371773e1;
  const T q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z +
                4.328810604912902668951e2) *
                   z +
               4.853903996359136964868e2) *
                  z +
              1.945506571482613964425e2;
  return base + (x * (z * (p / q)) + (x + low));
}

/// Arc tangent of a >= 0; for lanes arcTangentLanes, otherwise the usual atan.
template <class T>
[[gnu::always_inline]] inline T arcTangent(const T& a) {
  if constexpr (kIsLanes<T>) {
    return arcTangentLanes(a);
  } else {
    using std::atan;
    return atan(a);
  }
}

}  // namespace plumbline
