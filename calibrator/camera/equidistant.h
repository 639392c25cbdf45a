// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibrator/camera/lanes.h"
#include "calibrator/camera/pinhole.h"

namespace plumbline {

/// Equidistant (Kannala-Brandt) distortion of normalised coordinates, coefficients k1 k2 k3 k4
/// (OpenCV's fisheye, Kalibr's equidistant):
///   theta = atan(r),   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///   (x', y') = (theta_d / r) (x, y)
/// Being written on (X, Y) / Z, as in Kalibr, it ends at Z = 0: a field of view below 180 degrees.
struct Equidistant {
  static constexpr DistortionModel kModel = DistortionModel::kEquidistant;
  static constexpr int kCoefficients = 4;

  template <class T, class S>
  [[gnu::always_inline]] static inline Distorted<T, 4> distort(const S* k, const T& x, const T& y) {
    const T r2 = x * x + y * y;
    const T r = squareRoot(r2);
    const T theta = arcTangent(r);
    const T t2 = theta * theta;
    const T g = 1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])));
    const T growth =
        1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * (9.0 * k[3]))));
    // One division for three, which need not wait for the arc tangent.
    const T cos2_r = 1.0 / (r * (1.0 + r2));  // cos(theta)^2 / r
    const T inverse_r = cos2_r * (1.0 + r2);
    // Near the axis: series in r^2; the next terms are below 1e-24.
    const auto near = r2 < 1e-8;
    const T ratio_near = 1.0 + r2 * (r2 * 0.2 - 1.0 / 3.0);
    const T ratio = near ? ratio_near : T(theta * inverse_r);
    const T scale_near = 1.0 + r2 * ((k[0] - 1.0 / 3.0) + r2 * (0.2 - k[0] + k[1]));
    const T scale = near ? scale_near : T(ratio * g);
    const T slope_near = 2.0 * (k[0] - 1.0 / 3.0) + r2 * (4.0 * (0.2 - k[0] + k[1]));
    const T slope =
        near ? slope_near : T((growth * cos2_r - scale * inverse_r) * inverse_r);  // dscale/dx / x
    Distorted<T, 4> d;
    d.x = scale * x;
    d.y = scale * y;
    d.J_xx = scale + slope * x * x;
    d.J_xy = slope * x * y;
    d.J_yx = d.J_xy;
    d.J_yy = scale + slope * y * y;
    T power = ratio * t2;  // theta^2i theta / r
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      d.J_k[0][i] = power * x;
      d.J_k[1][i] = power * y;
      power = power * t2;
    }
    return d;
  }

  /// Radius after distortion, theta_d.
  static double radial(const double* k, double r) {
    const double theta = std::atan(r);
    const double t2 = theta * theta;
    return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  }

  /// tan^2 of the smallest theta in (0, pi/2) at which d theta_d / d theta reaches 0; infinite if
  /// none. Roots closer together than 1/256 of the range may be missed.
  static double squaredRadiusLimit(const double* k) {
    constexpr int kSteps = 256;
    double high = 0;
    int step = 1;
    while (step <= kSteps && growth(k, high = kWidest * step / kSteps) > 0) ++step;
    if (step > kSteps) return std::numeric_limits<double>::infinity();
    double low = kWidest * (step - 1) / kSteps;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (growth(k, middle) > 0 ? low : high) = middle;
    }
    const double tangent = std::tan(std::sqrt(low));
    return tangent * tangent;
  }

  /// By a lower bound of d theta_d / d theta up to theta^2 <= r^2: positive terms are not counted,
  /// negative ones at the end.
  static bool surelyGrows(const double* k, double r2) {
    const double falling[4] = {std::min(k[0], 0.0), std::min(k[1], 0.0), std::min(k[2], 0.0),
                               std::min(k[3], 0.0)};
    return growth(falling, std::min(r2, kWidest)) > 0;
  }

 private:
  static constexpr double kWidest = 0.25 * std::numbers::pi * std::numbers::pi;  // of theta^2

  // d theta_d / d theta at t2 = theta^2.
  static double growth(const double* k, double t2) {
    return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
  }
};

using PinholeEquidistant = Pinhole<Equidistant>;
static_assert(CameraModel<PinholeEquidistant>);

}  // namespace plumbline
