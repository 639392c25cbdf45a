// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "calibrator/camera/pinhole.h"

namespace plumbline {

/// No distortion, no coefficients: x' = x, y' = y (Kalibr's "none").
struct NoDistortion {
  static constexpr DistortionModel kModel = DistortionModel::kNone;
  static constexpr int kCoefficients = 0;

  template <class T, class S>
  [[gnu::always_inline]] static inline Distorted<T, 0> distort(const S*, const T& x, const T& y) {
    const T zero = x - x;
    Distorted<T, 0> d;
    d.x = x;
    d.y = y;
    d.J_xx = d.J_yy = zero + 1.0;
    d.J_xy = d.J_yx = zero;
    return d;
  }

  static double radial(const double*, double r) { return r; }
  static double squaredRadiusLimit(const double*) {
    return std::numeric_limits<double>::infinity();
  }
};

using PinholeNone = Pinhole<NoDistortion>;
static_assert(CameraModel<PinholeNone>);

}  // namespace plumbline
