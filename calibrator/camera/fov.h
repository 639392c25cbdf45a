// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "calibrator/camera/lanes.h"
#include "calibrator/camera/pinhole.h"

namespace plumbline {

/// Field-of-view distortion, one coefficient w [rad]: the angle of an ideal fisheye that spreads
/// the radius evenly over it (F. Devernay and O. Faugeras, "Straight lines have to be straight",
/// Machine Vision and Applications 13, 2001; Kalibr's "fov"):
///   r' = atan(2 r tan(w/2)) / w,   (x', y') = (r' / r) (x, y).
/// Even in w and without distortion as w goes to 0. Defined for |w| < pi, where it never folds back
/// and ends at r' = pi / (2 w).
struct Fov {
  static constexpr DistortionModel kModel = DistortionModel::kFov;
  static constexpr int kCoefficients = 1;

  template <class T, class S>
  [[gnu::always_inline]] static inline Distorted<T, 1> distort(const S* k, const T& x, const T& y) {
    const Widening<S> c(k[0]);
    const T r2 = x * x + y * y;
    // q(s) = atan(sqrt s) / sqrt s with s = (c.tangent r)^2, and dq/ds.
    const T s = c.tangent * c.tangent * r2;
    const auto near = s < 1e-4;  // series: the next terms are below 1e-20
    const T zero = s - s;
    const T safe = near ? zero + 1.0 : s;
    const T root = squareRoot(safe);
    const T q_far = arcTangent(root) / root;
    const T slope_far = 0.5 * (1.0 / (1.0 + safe) - q_far) / safe;
    const T q_near =
        1.0 + s * (-1.0 / 3.0 + s * (0.2 + s * (-1.0 / 7.0 + s * (1.0 / 9.0 - s / 11.0))));
    const T slope_near =
        -1.0 / 3.0 + s * (0.4 + s * (-3.0 / 7.0 + s * (4.0 / 9.0 - s * (5.0 / 11.0))));
    const T q = near ? q_near : q_far;
    const T slope = near ? slope_near : slope_far;
    const T scale = c.centre * q;  // r' / r
    const T by_r2 = c.centre * slope * c.tangent * c.tangent;
    const T by_w = c.centre_w * q + 2.0 * c.centre * slope * r2 * c.tangent * c.tangent_w;
    Distorted<T, 1> d;
    d.x = scale * x;
    d.y = scale * y;
    d.J_xx = scale + 2.0 * by_r2 * x * x;
    d.J_xy = 2.0 * by_r2 * x * y;
    d.J_yx = d.J_xy;
    d.J_yy = scale + 2.0 * by_r2 * y * y;
    d.J_k[0][0] = by_w * x;
    d.J_k[1][0] = by_w * y;
    return d;
  }

  /// Radius after distortion.
  static double radial(const double* k, double r) {
    const Widening<double> c(k[0]);
    const double a = c.tangent * r;
    return c.centre * r * (std::abs(a) < 1e-6 ? 1 - a * a / 3 : std::atan(a) / a);
  }

  /// Infinite: it grows for ever. 0 where w is out of range, so that nothing is projected.
  static double squaredRadiusLimit(const double* k) {
    return std::abs(k[0]) < std::numbers::pi ? std::numeric_limits<double>::infinity() : 0;
  }

 private:
  /// 2 tan(w/2), that over w (the magnification at the centre), and their derivatives by w.
  template <class S>
  struct Widening {
    S tangent, centre, tangent_w, centre_w;

    explicit Widening(const S& w) {
      using std::tan;
      tangent = 2.0 * tan(0.5 * w);
      tangent_w = 1.0 + 0.25 * tangent * tangent;
      const S w2 = w * w;
      if (w2 < S(1e-4)) {  // series: the next terms are below 1e-15
        centre = 1.0 + w2 * (1.0 / 12.0 + w2 * (1.0 / 120.0 + w2 * (17.0 / 20160.0)));
        centre_w = w * (1.0 / 6.0 + w2 * (1.0 / 30.0 + w2 * (17.0 / 3360.0)));
      } else {
        centre = tangent / w;
        centre_w = (tangent_w - centre) / w;
      }
    }
  };
};

using PinholeFov = Pinhole<Fov>;
static_assert(CameraModel<PinholeFov>);

}  // namespace plumbline
