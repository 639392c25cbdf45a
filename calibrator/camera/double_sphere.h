// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>

#include "calibrator/camera/camera_model.h"
#include "calibrator/camera/lanes.h"

namespace plumbline {

/// Double sphere model (V. Usenko, N. Demmel and D. Cremers, "The double sphere camera model", 3DV
/// 2018; Kalibr's "ds"):
///   d1 = |p_C|,   z = xi d1 + Z,   d2 = sqrt(X^2 + Y^2 + z^2),
///   m = (X, Y) / (alpha d2 + (1 - alpha) z).
/// Parameters xi, alpha in [0, 1], fu, fv, pu, pv; no distortion. The point goes through two unit
/// spheres, xi apart; xi = 0 and alpha = 0 are a pinhole. Defined and one-to-one where the second
/// sphere shows it,
///   z > -w d2,   w = alpha / (1 - alpha) up to alpha = 1/2, (1 - alpha) / alpha above,
/// and, for |xi| > 1, where the first does: d1 + xi Z > 0.
struct DoubleSphere {
  static constexpr ProjectionModel kProjection = ProjectionModel::kDs;
  static constexpr DistortionModel kDistortion = DistortionModel::kNone;
  static constexpr int kLeading = 2;
  static constexpr int kShape = 2;

  /// p_C = (X, Y, Z) [m] to the image plane, with Jacobians. No check of the domain.
  template <class T, class S>
  [[gnu::always_inline]] static inline PlanePoint<T, 2> image(const S* k, const T& X, const T& Y,
                                                              const T& Z) {
    const S& xi = k[0];
    const S& alpha = k[1];
    const T d1 = squareRoot(T(X * X + Y * Y + Z * Z));
    const T z = xi * d1 + Z;
    const T d2 = squareRoot(T(X * X + Y * Y + z * z));
    const T pull = xi / d1;
    // Derivatives of z by (X, Y, Z) are pull * (X, Y, Z) + (0, 0, 1); those of D through z:
    const T by_z = alpha * z / d2 + (1.0 - alpha);
    const T share = alpha / d2;
    Divisor<T, 2> by;
    by.D = alpha * d2 + (1.0 - alpha) * z;
    by.J_point[0] = share * X + by_z * (pull * X);
    by.J_point[1] = share * Y + by_z * (pull * Y);
    by.J_point[2] = by_z * (pull * Z + 1.0);
    by.J_k[0] = by_z * d1;
    by.J_k[1] = d2 - z;
    return divided<2>(X, Y, by);
  }

  template <class T, class S>
  static bool isProjectable(const S* k, const T& X, const T& Y, const T& Z) {
    using std::sqrt;
    const S one(1);
    const T d1 = sqrt(X * X + Y * Y + Z * Z);
    const T z = k[0] * d1 + Z;
    const T d2 = sqrt(X * X + Y * Y + z * z);
    const S w = k[1] > S(0.5) ? S((one - k[1]) / k[1]) : S(k[1] / (one - k[1]));
    return z > -w * d2 && d1 + k[0] * Z > T(0);
  }

  /// Whether the model projects p_C one-to-one.
  static bool isInDomain(const double* k, double X, double Y, double Z) {
    return isProjectable(k, X, Y, Z);
  }

  /// The point of the first sphere whose image is m.
  static std::optional<RayDirection> ray(const double* k, double m_x, double m_y) {
    const double xi = k[0];
    const double alpha = k[1];
    const double r2 = m_x * m_x + m_y * m_y;
    const double under_root = 1 - (2 * alpha - 1) * r2;
    if (!(under_root >= 0)) return std::nullopt;
    const double z = (1 - alpha * alpha * r2) / (alpha * std::sqrt(under_root) + (1 - alpha));
    const double under_second = z * z + (1 - xi * xi) * r2;
    if (!(under_second >= 0)) return std::nullopt;
    const double reach = (z * xi + std::sqrt(under_second)) / (z * z + r2);
    const RayDirection out{reach * m_x, reach * m_y, reach * z - xi};
    if (!isProjectable(k, out[0], out[1], out[2])) return std::nullopt;
    return out;
  }
};
static_assert(CameraModel<DoubleSphere>);

}  // namespace plumbline
