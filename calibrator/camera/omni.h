// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>

#include "calibrator/camera/camera_model.h"
#include "calibrator/camera/distortion.h"
#include "calibrator/camera/equidistant.h"
#include "calibrator/camera/fov.h"
#include "calibrator/camera/lanes.h"
#include "calibrator/camera/pinhole.h"
#include "calibrator/camera/radtan.h"

namespace plumbline {

/// Unified omnidirectional projection, then a distortion of the plane (C. Mei and P. Rives, "Single
/// view point omnidirectional camera calibration from planar grids", ICRA 2007; Kalibr's "omni"):
///   (x, y) = (X, Y) / (Z + xi |p_C|),   m = distort(x, y).
/// Parameters xi, fu, fv, pu, pv, then the distortion's. The point is put on the unit sphere and
/// seen from xi behind its centre; xi = 0 is a pinhole. Defined and one-to-one for
///   Z > -min(xi, 1/xi) |p_C|
/// (Kalibr's limit, with xi >= 0), which reaches beyond 180 degrees of view, and below the radius
/// at which the distortion folds back.
template <class Distortion>
struct Omni {
  static constexpr ProjectionModel kProjection = ProjectionModel::kOmni;
  static constexpr DistortionModel kDistortion = Distortion::kModel;
  static constexpr int kLeading = 1;
  static constexpr int kShape = 1 + Distortion::kCoefficients;

  /// p_C = (X, Y, Z) [m] to the image plane, with Jacobians. No check of the domain.
  template <class T, class S>
  [[gnu::always_inline]] static inline PlanePoint<T, kShape> image(const S* k, const T& X,
                                                                   const T& Y, const T& Z) {
    const T distance = squareRoot(T(X * X + Y * Y + Z * Z));
    const T pull = k[0] / distance;
    const PlanePoint<T, 1> p = divided<1>(
        X, Y, Divisor<T, 1>{Z + k[0] * distance, {pull * X, pull * Y, 1.0 + pull * Z}, {distance}});
    const Distorted<T, Distortion::kCoefficients> d = Distortion::distort(k + 1, p.x, p.y);
    PlanePoint<T, kShape> m;
    m.x = d.x;
    m.y = d.y;
    for (int j = 0; j < 3; ++j) {
      m.J_point[0][j] = d.J_xx * p.J_point[0][j] + d.J_xy * p.J_point[1][j];
      m.J_point[1][j] = d.J_yx * p.J_point[0][j] + d.J_yy * p.J_point[1][j];
    }
    m.J_k[0][0] = d.J_xx * p.J_k[0][0] + d.J_xy * p.J_k[1][0];
    m.J_k[1][0] = d.J_yx * p.J_k[0][0] + d.J_yy * p.J_k[1][0];
    for (int i = 0; i < Distortion::kCoefficients; ++i) {
      m.J_k[0][1 + i] = d.J_k[0][i];
      m.J_k[1][1 + i] = d.J_k[1][i];
    }
    return m;
  }

  /// Whether the sphere's point is on the side that the plane shows.
  template <class T, class S>
  static bool isProjectable(const S* k, const T& X, const T& Y, const T& Z) {
    using std::sqrt;
    const T distance = sqrt(X * X + Y * Y + Z * Z);
    const S reach = k[0] > S(1) ? S(1.0 / k[0]) : k[0];
    return Z > -reach * distance && distance > T(0);
  }

  /// Whether the model projects p_C one-to-one.
  static bool isInDomain(const double* k, double X, double Y, double Z) {
    if (!isProjectable(k, X, Y, Z)) return false;
    const double D = Z + k[0] * std::sqrt(X * X + Y * Y + Z * Z);
    return isBelowLimit<Distortion>(k + 1, (X * X + Y * Y) / (D * D));
  }

  /// The point of the unit sphere whose image is m.
  static std::optional<RayDirection> ray(const double* k, double m_x, double m_y) {
    const auto p = undistorted<Distortion>(k + 1, m_x, m_y);
    if (!p) return std::nullopt;
    const auto [x, y] = *p;
    const double xi = k[0];
    const double r2 = x * x + y * y;
    const double under_root = 1 + (1 - xi * xi) * r2;
    if (!(under_root >= 0)) return std::nullopt;
    const double reach = (xi + std::sqrt(under_root)) / (1 + r2);
    const RayDirection out{reach * x, reach * y, reach - xi};
    if (!isProjectable(k, out[0], out[1], out[2])) return std::nullopt;
    return out;
  }
};

using OmniNone = Omni<NoDistortion>;
using OmniRadtan = Omni<Radtan>;
using OmniEquidistant = Omni<Equidistant>;
using OmniFov = Omni<Fov>;
static_assert(CameraModel<OmniNone> && CameraModel<OmniRadtan>);
static_assert(CameraModel<OmniEquidistant> && CameraModel<OmniFov>);

}  // namespace plumbline
