// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <optional>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// Coordinates m on the image plane, before focal length and principal point, with derivatives:
///   u = fu m_x + pu,   v = fv m_y + pv.
/// T is the arithmetic: double, ceres::Jet, or a vector of SIMD lanes (GCC vector extension).
template <class T, int kShape>
struct PlanePoint {
  T x, y;            ///< m [-]
  T J_point[2][3];   ///< d m / d p_C [1/m]
  T J_k[2][kShape];  ///< d m / d shape coefficients
};

/// Direction of a ray in the camera frame, of any length.
using RayDirection = std::array<double, 3>;

/// What a camera model is to this project: one type without state, in one file of its own, and one
/// entry in AnyCameraModel (camera_dispatch.h).
///
/// Every model of Kalibr ends in fu, fv, pu, pv; what lies before is its "shape": kShape
/// coefficients and a function of the point in the camera frame.
/// - image() must be free of branches on T (choose with ?:), so that it runs on SIMD lanes, and
///   must be always_inline, so that it is compiled for the instruction set of the kernel that calls
///   it. It does not check the domain.
/// - isInDomain(): whether the point's projection is defined and one-to-one.
/// - ray(): the direction whose image is m, to 1e-12; empty where there is none in the domain.
template <class Model>
concept CameraModel = requires(const double* k, double s) {
  { Model::kProjection } -> std::convertible_to<ProjectionModel>;
  { Model::kDistortion } -> std::convertible_to<DistortionModel>;
  { Model::kShape } -> std::convertible_to<int>;
  { Model::image(k, s, s, s) } -> std::same_as<PlanePoint<double, Model::kShape>>;
  { Model::isInDomain(k, s, s, s) } -> std::same_as<bool>;
  { Model::ray(k, s, s) } -> std::same_as<std::optional<RayDirection>>;
};

}  // namespace plumbline
