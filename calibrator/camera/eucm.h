// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>

#include "calibrator/camera/camera_model.h"
#include "calibrator/camera/lanes.h"

namespace plumbline {

/// Enhanced unified camera model (B. Khomutenko, G. Garcia and P. Martinet, "An enhanced unified
/// camera model", RA-L 1(1), 2016; Kalibr's "eucm"):
///   d = sqrt(beta (X^2 + Y^2) + Z^2),   m = (X, Y) / (alpha d + (1 - alpha) Z).
/// Parameters alpha in [0, 1], beta > 0, fu, fv, pu, pv; no distortion. alpha = 0 is a pinhole.
/// Defined and one-to-one for
///   Z > -w d,   w = alpha / (1 - alpha) up to alpha = 1/2, (1 - alpha) / alpha above:
/// the divisor is positive, and above 1/2 the image still grows with the angle to the axis.
struct Eucm {
  static constexpr ProjectionModel kProjection = ProjectionModel::kEucm;
  static constexpr DistortionModel kDistortion = DistortionModel::kNone;
  static constexpr int kLeading = 2;
  static constexpr int kShape = 2;

  /// p_C = (X, Y, Z) [m] to the image plane, with Jacobians. No check of the domain.
  template <class T, class S>
  [[gnu::always_inline]] static inline PlanePoint<T, 2> image(const S* k, const T& X, const T& Y,
                                                              const T& Z) {
    const S& alpha = k[0];
    const S& beta = k[1];
    const T r2 = X * X + Y * Y;
    const T d = squareRoot(T(beta * r2 + Z * Z));
    const T share = alpha / d;
    return divided<2>(X, Y,
                      Divisor<T, 2>{alpha * d + (1.0 - alpha) * Z,
                                    {share * beta * X, share * beta * Y, share * Z + (1.0 - alpha)},
                                    {d - Z, 0.5 * share * r2}});
  }

  template <class T, class S>
  static bool isProjectable(const S* k, const T& X, const T& Y, const T& Z) {
    using std::sqrt;
    const T d = sqrt(k[1] * (X * X + Y * Y) + Z * Z);
    const S one(1);
    const S w = k[0] > S(0.5) ? S((one - k[0]) / k[0]) : S(k[0] / (one - k[0]));
    return Z > -w * d && d > T(0);
  }

  /// Whether the model projects p_C one-to-one.
  static bool isInDomain(const double* k, double X, double Y, double Z) {
    return isProjectable(k, X, Y, Z);
  }

  /// (m_x, m_y, z) with z solved from the projection's equation.
  static std::optional<RayDirection> ray(const double* k, double m_x, double m_y) {
    const double alpha = k[0];
    const double r2 = k[1] * (m_x * m_x + m_y * m_y);
    const double under_root = 1 - (2 * alpha - 1) * r2;
    if (!(under_root >= 0)) return std::nullopt;
    const double z = (1 - alpha * alpha * r2) / (alpha * std::sqrt(under_root) + (1 - alpha));
    const RayDirection out{m_x, m_y, z};
    if (!isProjectable(k, out[0], out[1], out[2])) return std::nullopt;
    return out;
  }
};
static_assert(CameraModel<Eucm>);

}  // namespace plumbline
