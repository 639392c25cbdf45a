// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <optional>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// Coordinates m on the image plane, before focal length and principal point, with derivatives:
///   u = fu m_x + pu,   v = fv m_y + pv.
/// T is the arithmetic: double, ceres::Jet, or a vector of SIMD lanes (GCC vector extension).
template <class T, int kShape>
struct PlanePoint {
  T x, y;                             ///< m [-]
  T J_point[2][3];                    ///< d m / d p_C [1/m]
  T J_k[2][kShape > 0 ? kShape : 1];  ///< d m / d shape coefficients
};

/// The plane point (X, Y) / D with its derivatives, from those of the divisor D (by p_C, and by
/// kShape coefficients).
template <class T, int kShape>
struct Divisor {
  T D;                             ///< [m]
  T J_point[3];                    ///< d D / d p_C [-]
  T J_k[kShape > 0 ? kShape : 1];  ///< d D / d coefficients [m]
};
template <int kShape, class T>
[[gnu::always_inline]] inline PlanePoint<T, kShape> divided(const T& X, const T& Y,
                                                            const Divisor<T, kShape>& by) {
  const T inverse = 1.0 / by.D;
  PlanePoint<T, kShape> m;
  m.x = X * inverse;
  m.y = Y * inverse;
  m.J_point[0][0] = (1.0 - m.x * by.J_point[0]) * inverse;
  m.J_point[0][1] = -(m.x * by.J_point[1]) * inverse;
  m.J_point[0][2] = -(m.x * by.J_point[2]) * inverse;
  m.J_point[1][0] = -(m.y * by.J_point[0]) * inverse;
  m.J_point[1][1] = (1.0 - m.y * by.J_point[1]) * inverse;
  m.J_point[1][2] = -(m.y * by.J_point[2]) * inverse;
  for (int i = 0; i < kShape; ++i) {
    m.J_k[0][i] = -(m.x * by.J_k[i]) * inverse;
    m.J_k[1][i] = -(m.y * by.J_k[i]) * inverse;
  }
  return m;
}

/// A camera's parameters as its model takes them: the lens, and the shape without a gap.
struct CameraValues {
  static constexpr int kMostShape = 8;  // of the rational model
  double fu, fv, pu, pv;
  std::array<double, kMostShape> k{};

  /// Sizes as the camera's models say (cameraModelOf() checks them).
  explicit CameraValues(const Intrinsics& camera) {
    const auto leading = static_cast<std::size_t>(camera.projection.size() - 4);
    const auto lens = camera.projection.tail<4>();
    fu = lens[0];
    fv = lens[1];
    pu = lens[2];
    pv = lens[3];
    std::copy_n(camera.projection.data(), leading, k.begin());
    std::copy_n(camera.distortion.data(), camera.distortion.size(),
                k.begin() + static_cast<std::ptrdiff_t>(leading));
  }
};

/// Column of Intrinsics::stacked() at which shape coefficient i of a model stands.
template <class Model>
constexpr int shapeColumn(int i) {
  return i < Model::kLeading ? i : 4 + i;
}

/// Direction of a ray in the camera frame, of any length.
using RayDirection = std::array<double, 3>;

/// What a camera model is to this project: one type without state, in one file of its own, and one
/// entry in AnyCameraModel (camera_dispatch.h).
///
/// Every model of Kalibr ends in fu, fv, pu, pv; what lies before is its "shape": kShape
/// coefficients k and a function of the point in the camera frame. In Intrinsics::stacked() the
/// first kLeading of them (xi, alpha, beta: the projection's) stand before fu fv pu pv, the others
/// (the distortion's) after; k holds them without a gap, as CameraValues does.
/// - image() must be free of branches on T (choose with ?:), so that it runs on SIMD lanes, and
///   must be always_inline, so that it is compiled for the instruction set of the kernel that calls
///   it. It does not check the domain.
/// - isProjectable(): whether image() means anything there: the projection is defined and
///   one-to-one, whatever the distortion does. S and T may be ceres::Jet.
/// - isInDomain(): isProjectable(), and below the radius at which the distortion folds back.
/// - ray(): the direction whose image is m, to 1e-12; empty where there is none in the domain.
template <class Model>
concept CameraModel = requires(const double* k, double s) {
  { Model::kProjection } -> std::convertible_to<ProjectionModel>;
  { Model::kDistortion } -> std::convertible_to<DistortionModel>;
  { Model::kShape } -> std::convertible_to<int>;
  { Model::kLeading } -> std::convertible_to<int>;
  { Model::image(k, s, s, s) } -> std::same_as<PlanePoint<double, Model::kShape>>;
  { Model::isProjectable(k, s, s, s) } -> std::same_as<bool>;
  { Model::isInDomain(k, s, s, s) } -> std::same_as<bool>;
  { Model::ray(k, s, s) } -> std::same_as<std::optional<RayDirection>>;
};

}  // namespace plumbline
