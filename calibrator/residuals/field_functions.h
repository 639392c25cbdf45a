// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to field_gram.cpp: the functions of a misfit field, several pixels at a time, always
// inlined as gram_kernel.h says.

#include <iterator>

#include "calibrator/camera/lanes.h"
#include "calibrator/residuals/field_gram.h"

namespace plumbline::fields {

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
template <int W, class Scalar>
[[gnu::always_inline]] inline void legendre(const Lanes<W, Scalar>& x,
                                            Lanes<W, Scalar> (&P)[kFieldDegree + 1]) {
  constexpr double kNorm[] = {1,   kRootOf3,          2.2360679774997897, 2.6457513110645906,
                              3.0, 3.3166247903553998};
  static_assert(std::size(kNorm) == kFieldDegree + 1);
  P[0] = Lanes<W, Scalar>{} + Scalar(1);
  P[1] = x;
#pragma GCC unroll 8
  for (int k = 1; k < kFieldDegree; ++k) {
    P[k + 1] = Scalar((2.0 * k + 1) / (k + 1)) * x * P[k] -
               Scalar(static_cast<double>(k) / (k + 1)) * P[k - 1];
  }
#pragma GCC unroll 8
  for (int k = 1; k <= kFieldDegree; ++k) P[k] *= Scalar(kNorm[k]);
}

/// Calls put(number, value) for each function at clampedPlace()s x, y of the box.
template <int W, class Scalar, class Put>
[[gnu::always_inline]] inline void eachFunction(const FieldBox& box, const Lanes<W, Scalar>& x,
                                                const Lanes<W, Scalar>& y, const Put& put) {
  Lanes<W, Scalar> X[kFieldDegree + 1];
  Lanes<W, Scalar> Y[kFieldDegree + 1];
  legendre<W, Scalar>(x, X);
  legendre<W, Scalar>(y, Y);
  int number = 0;
#pragma GCC unroll 8
  for (int i = 0; i <= kFieldDegree; ++i) {
#pragma GCC unroll 8
    for (int j = 0; i + j <= kFieldDegree; ++j) put(number++, X[i] * Y[j]);
  }
  const double unit = 1 / box.half.norm();
  const Eigen::Vector2d scale = unit * box.half;
  const Eigen::Vector2d centre = unit * (box.centre - box.axis);
  const Lanes<W, Scalar> du = x * Scalar(scale[0]) + Scalar(centre[0]);
  const Lanes<W, Scalar> dv = y * Scalar(scale[1]) + Scalar(centre[1]);
  const Lanes<W, Scalar> r2 = du * du + dv * dv;
  Lanes<W, Scalar> power = r2 * r2;
#pragma GCC unroll 8
  for (int k = 0; k < kFieldRadials; ++k) {
    power *= r2;
    put(number++, du * power);
    put(number++, dv * power);
  }
}

}  // namespace plumbline::fields
