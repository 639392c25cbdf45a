// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibrator/camera/pinhole.h"

namespace plumbline {

/// Radial distortion as a ratio of polynomials, and tangential terms: coefficients k1 k2 p1 p2 k3
/// k4 k5 k6 in OpenCV's order (its "rational model", ROS' rational_polynomial):
///   g = N / D = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3),   s = x^2 + y^2
///   x' = x g + 2 p1 x y + p2 (s + 2 x^2),   y' = y g + p1 (s + 2 y^2) + 2 p2 x y
/// With k3 to k6 zero it is radtan. Defined up to the radius at which r g stops growing or D
/// reaches 0.
struct Rational {
  static constexpr DistortionModel kModel = DistortionModel::kRational;
  static constexpr int kCoefficients = 8;

  template <class T, class S>
  [[gnu::always_inline]] static inline Distorted<T, 8> distort(const S* k, const T& x, const T& y) {
    const T xx = x * x;
    const T yy = y * y;
    const T xy2 = 2.0 * x * y;
    const T s = xx + yy;
    const T N = 1.0 + s * (k[0] + s * (k[1] + s * k[4]));
    const T inverse_D = 1.0 / (1.0 + s * (k[5] + s * (k[6] + s * k[7])));
    const T g = N * inverse_D;
    const T N_s = k[0] + s * (2.0 * k[1] + s * (3.0 * k[4]));
    const T D_s = k[5] + s * (2.0 * k[6] + s * (3.0 * k[7]));
    const T slope = 2.0 * (N_s - g * D_s) * inverse_D;  // dg/dx = slope x
    Distorted<T, 8> d;
    d.x = x * g + k[2] * xy2 + k[3] * (s + 2.0 * xx);
    d.y = y * g + k[2] * (s + 2.0 * yy) + k[3] * xy2;
    d.J_xx = g + slope * xx + 2.0 * k[2] * y + 6.0 * k[3] * x;
    d.J_xy = slope * x * y + 2.0 * k[2] * x + 2.0 * k[3] * y;
    d.J_yx = d.J_xy;
    d.J_yy = g + slope * yy + 6.0 * k[2] * y + 2.0 * k[3] * x;
    const T by_N = s * inverse_D;  // dg/dk1
    const T by_D = -g * by_N;      // dg/dk4
    const T radial[8] = {by_N, by_N * s, s - s, s - s, by_N * s * s, by_D, by_D * s, by_D * s * s};
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) {
      d.J_k[0][i] = radial[i] * x;
      d.J_k[1][i] = radial[i] * y;
    }
    d.J_k[0][2] = xy2;
    d.J_k[0][3] = s + 2.0 * xx;
    d.J_k[1][2] = s + 2.0 * yy;
    d.J_k[1][3] = xy2;
    return d;
  }

  /// Radius after radial distortion, r g(r).
  static double radial(const double* k, double r) {
    const double s = r * r;
    return r * numerator(k, s) / denominator(k, s);
  }

  /// tan^2 of the smallest angle in (0, pi/2) at which d(r g)/dr or D reaches 0; infinite if none.
  /// Roots closer together than 1/512 of the range may be missed.
  static double squaredRadiusLimit(const double* k) {
    constexpr int kSteps = 512;
    double low = 0;
    double high = 0;
    for (int step = 1; step < kSteps; ++step) {
      const double tangent = std::tan(0.5 * std::numbers::pi * step / kSteps);
      high = tangent * tangent;
      if (!grows(k, high)) break;
      low = high;
    }
    if (low == high) return std::numeric_limits<double>::infinity();
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (grows(k, middle) ? low : high) = middle;
    }
    return low;
  }

  /// By lower bounds of D and of D^2 d(r g)/dr over [0, r^2]: positive terms are not counted,
  /// negative ones at the end.
  static bool surelyGrows(const double* k, double r2) {
    const std::array<double, 4> N = {1, k[0], k[1], k[4]};
    const std::array<double, 4> D = {1, k[5], k[6], k[7]};
    std::array<double, 7> slope{};  // N D + 2 s (N' D - N D')
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        const auto by = static_cast<double>(i) - static_cast<double>(j);
        slope[i + j] += (1 + 2 * by) * N[i] * D[j];
      }
    }
    return lowerBound(D, r2) > 0 && lowerBound(slope, r2) > 0;
  }

 private:
  static double numerator(const double* k, double s) {
    return 1 + s * (k[0] + s * (k[1] + s * k[4]));
  }
  static double denominator(const double* k, double s) {
    return 1 + s * (k[5] + s * (k[6] + s * k[7]));
  }
  static bool grows(const double* k, double s) {
    const double N = numerator(k, s);
    const double D = denominator(k, s);
    const double N_s = k[0] + s * (2 * k[1] + s * 3 * k[4]);
    const double D_s = k[5] + s * (2 * k[6] + s * 3 * k[7]);
    return D > 0 && N * D + 2 * s * (N_s * D - N * D_s) > 0;
  }
  template <std::size_t kSize>
  static double lowerBound(const std::array<double, kSize>& polynomial, double s) {
    double sum = polynomial[0];
    double power = s;
    for (std::size_t i = 1; i < kSize; ++i) {
      sum += std::min(polynomial[i], 0.0) * power;
      power *= s;
    }
    return sum;
  }
};

using PinholeRational = Pinhole<Rational>;
static_assert(CameraModel<PinholeRational>);

}  // namespace plumbline
