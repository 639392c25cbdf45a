// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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
  static constexpr ProjectionModel kProjection = ProjectionModel::kPinhole;
  static constexpr DistortionModel kDistortion = Distortion::kModel;
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

  /// The ray (x, y, 1) with distort(x, y) = (m_x, m_y), by Newton's method.
  static std::optional<RayDirection> ray(const double* k, double m_x, double m_y) {
    const double radius = std::hypot(m_x, m_y);
    if (!std::isfinite(radius)) return std::nullopt;
    const double scale = radius > 0 ? startRadius(k, radius) / radius : 0;
    double x = scale * m_x;
    double y = scale * m_y;
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMostSteps; ++i) {
      const auto d = Distortion::distort(k, x, y);
      const double miss_x = d.x - m_x;
      const double miss_y = d.y - m_y;
      const double miss = std::hypot(miss_x, miss_y);
      // Done at rounding, or where it no longer improves.
      if (miss <= 4e-15 * (1 + radius) || (miss < 1e-12 && miss >= last)) {
        if (x * x + y * y < Distortion::squaredRadiusLimit(k)) return RayDirection{x, y, 1};
        return std::nullopt;
      }
      last = miss;
      const double determinant = d.J_xx * d.J_yy - d.J_xy * d.J_yx;
      x -= (d.J_yy * miss_x - d.J_xy * miss_y) / determinant;
      y -= (d.J_xx * miss_y - d.J_yx * miss_x) / determinant;
      if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  static constexpr int kMostSteps = 50;

  // The undistorted radius whose radial distortion is `target`, by bisection: a start for Newton
  // that is on the right side of the fold.
  static double startRadius(const double* k, double target) {
    constexpr double kWidest = 1e4;  // tangent of the angle to the axis
    double low = 0;
    double high = std::min(kWidest, std::sqrt(Distortion::squaredRadiusLimit(k)));
    if (Distortion::radial(k, high) <= target) return high * (1 - 1e-6);
    for (int i = 0; i < kMostSteps; ++i) {
      const double middle = 0.5 * (low + high);
      (Distortion::radial(k, middle) < target ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

}  // namespace plumbline
