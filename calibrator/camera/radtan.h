// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "calibrator/camera/pinhole.h"

namespace plumbline {

/// Radial-tangential distortion, coefficients k1 k2 p1 p2 (OpenCV's first four, Kalibr's radtan):
///   g = 1 + k1 r^2 + k2 r^4,   r^2 = x^2 + y^2
///   x' = x g + 2 p1 x y + p2 (r^2 + 2 x^2)
///   y' = y g + p1 (r^2 + 2 y^2) + 2 p2 x y
struct Radtan {
  static constexpr DistortionModel kModel = DistortionModel::kRadtan;
  static constexpr int kCoefficients = 4;

  template <class T, class S>
  [[gnu::always_inline]] static inline Distorted<T, 4> distort(const S* k, const T& x, const T& y) {
    const T xx = x * x;
    const T yy = y * y;
    const T xy2 = 2.0 * x * y;
    const T r2 = xx + yy;
    const T r4 = r2 * r2;
    const T g = 1.0 + r2 * (k[0] + r2 * k[1]);
    const T slope = 2.0 * (k[0] + 2.0 * k[1] * r2);  // dg/dx = slope x
    Distorted<T, 4> d;
    d.x = x * g + k[2] * xy2 + k[3] * (r2 + 2.0 * xx);
    d.y = y * g + k[2] * (r2 + 2.0 * yy) + k[3] * xy2;
    d.J_xx = g + slope * xx + 2.0 * k[2] * y + 6.0 * k[3] * x;
    d.J_xy = slope * x * y + 2.0 * k[2] * x + 2.0 * k[3] * y;
    d.J_yx = d.J_xy;
    d.J_yy = g + slope * yy + 6.0 * k[2] * y + 2.0 * k[3] * x;
    d.J_k[0][0] = x * r2;
    d.J_k[0][1] = x * r4;
    d.J_k[0][2] = xy2;
    d.J_k[0][3] = r2 + 2.0 * xx;
    d.J_k[1][0] = y * r2;
    d.J_k[1][1] = y * r4;
    d.J_k[1][2] = r2 + 2.0 * yy;
    d.J_k[1][3] = xy2;
    return d;
  }

  /// Radius after radial distortion, r g(r).
  static double radial(const double* k, double r) {
    const double r2 = r * r;
    return r * (1 + r2 * (k[0] + r2 * k[1]));
  }

  /// Smallest r^2 > 0 at which d(r g)/dr = 1 + 3 k1 r^2 + 5 k2 r^4 reaches 0; infinite if never.
  static double squaredRadiusLimit(const double* k) {
    const double a = 5 * k[1];
    const double b = 3 * k[0];
    const double discriminant = b * b - 4 * a;
    const double never = std::numeric_limits<double>::infinity();
    if (discriminant < 0) return never;
    // 2 / (-b +- root) are the roots of a s^2 + b s + 1, without cancellation for small a.
    const double root = std::sqrt(discriminant);
    if (-b + root <= 0) return never;
    return 2 / (-b + root);
  }
};

using PinholeRadtan = Pinhole<Radtan>;
static_assert(CameraModel<PinholeRadtan>);

}  // namespace plumbline
