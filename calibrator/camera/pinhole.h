// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/camera/camera_model.h"

namespace plumbline {

/// Distorted normalised coordinates with derivatives.
template <class T, int kCoefficients>
struct Distorted {
  T x, y;                    ///< [-]
  T J_xx, J_xy, J_yx, J_yy;  ///< J_ab = d distorted a / d undistorted b
  T J_k[2][kCoefficients];   ///< d (x, y) / d coefficients
};

/// Pinhole projection followed by a distortion of the normalised coordinates (x, y) = (X, Y) / Z.
/// Defined for Z > 0 and below the radius at which the radial distortion stops growing: beyond it
/// two points share a pixel. The tangential terms of radtan do not enter that limit.
template <class Distortion>
struct Pinhole {
  static constexpr int kShape = Distortion::kCoefficients;

  /// p_C = (X, Y, Z) [m] to the image plane, with Jacobians. No check of the domain.
  template <class T, class S>
  [[gnu::always_inline]] static inline PlanePoint<T, kShape> image(const S* k, const T& X,
                                                                   const T& Y, const T& Z) {
    const T inverse_Z = 1.0 / Z;
    const T x = X * inverse_Z;
    const T y = Y * inverse_Z;
    const Distorted<T, kShape> d = Distortion::distort(k, x, y);
    // Entry by entry: copies of whole arrays would go through memory.
    PlanePoint<T, kShape> m;
    m.x = d.x;
    m.y = d.y;
    m.J_point[0][0] = d.J_xx * inverse_Z;
    m.J_point[0][1] = d.J_xy * inverse_Z;
    m.J_point[0][2] = -(d.J_xx * x + d.J_xy * y) * inverse_Z;
    m.J_point[1][0] = d.J_yx * inverse_Z;
    m.J_point[1][1] = d.J_yy * inverse_Z;
    m.J_point[1][2] = -(d.J_yx * x + d.J_yy * y) * inverse_Z;
#pragma GCC unroll 8
    for (int i = 0; i < kShape; ++i) {
      m.J_k[0][i] = d.J_k[0][i];
      m.J_k[1][i] = d.J_k[1][i];
    }
    return m;
  }

  /// Whether the model projects p_C one-to-one.
  static bool isInDomain(const double* k, double X, double Y, double Z) {
    if (!(Z > 0)) return false;
    const double r2 = (X * X + Y * Y) / (Z * Z);
    return r2 < Distortion::squaredRadiusLimit(k);
  }
};

}  // namespace plumbline
