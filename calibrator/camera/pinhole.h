// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "calibrator/camera/camera_model.h"
#include "calibrator/camera/distortion.h"

namespace plumbline {

/// Pinhole projection followed by a distortion of the normalised coordinates (x, y) = (X, Y) / Z.
/// Defined for Z > 0 and below the radius at which the radial distortion stops growing: beyond it
/// two points share a pixel. The tangential terms of radtan do not enter that limit.
template <class Distortion>
struct Pinhole {
  static constexpr ProjectionModel kProjection = ProjectionModel::kPinhole;
  static constexpr DistortionModel kDistortion = Distortion::kModel;
  static constexpr int kShape = Distortion::kCoefficients;
  static constexpr int kLeading = 0;

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

  /// Ahead of the camera, and not so close that the division loses its meaning.
  template <class T, class S>
  static bool isProjectable(const S*, const T&, const T&, const T& Z) {
    return Z > T(kNearest);
  }

  /// Whether the model projects p_C one-to-one.
  static bool isInDomain(const double* k, double X, double Y, double Z) {
    if (!(Z > 0)) return false;
    return isBelowLimit<Distortion>(k, (X * X + Y * Y) / (Z * Z));
  }

  /// The ray (x, y, 1) with distort(x, y) = (m_x, m_y).
  static std::optional<RayDirection> ray(const double* k, double m_x, double m_y) {
    const auto m = undistorted<Distortion>(k, m_x, m_y);
    if (!m) return std::nullopt;
    return RayDirection{(*m)[0], (*m)[1], 1};
  }

 private:
  static constexpr double kNearest = 1e-9;  // [m]
};

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
