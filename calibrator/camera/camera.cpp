// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/camera/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrator/base/error.h"
#include "calibrator/camera/camera_dispatch.h"

namespace plumbline {
namespace {

// fu fv pu pv, which every model has.
struct Lens {
  double fu, fv, pu, pv;
  explicit Lens(const Intrinsics& camera)
      : fu(camera.projection[0]),
        fv(camera.projection[1]),
        pu(camera.projection[2]),
        pv(camera.projection[3]) {}
};

template <CameraModel Model>
std::optional<Eigen::Vector2d> projectAs(Model, const Intrinsics& camera,
                                         const Eigen::Vector3d& p_C) {
  const double* k = camera.distortion.data();
  if (!Model::isInDomain(k, p_C.x(), p_C.y(), p_C.z())) return std::nullopt;
  const auto m = Model::image(k, p_C.x(), p_C.y(), p_C.z());
  const Lens lens(camera);
  return Eigen::Vector2d(lens.fu * m.x + lens.pu, lens.fv * m.y + lens.pv);
}

template <CameraModel Model>
std::optional<Projection> projectWithJacobiansAs(Model, const Intrinsics& camera,
                                                 const Eigen::Vector3d& p_C) {
  const double* k = camera.distortion.data();
  if (!Model::isInDomain(k, p_C.x(), p_C.y(), p_C.z())) return std::nullopt;
  const auto m = Model::image(k, p_C.x(), p_C.y(), p_C.z());
  const Lens lens(camera);
  Projection out;
  out.uv << lens.fu * m.x + lens.pu, lens.fv * m.y + lens.pv;
  for (int j = 0; j < 3; ++j) {
    out.J_point.col(j) << lens.fu * m.J_point[0][j], lens.fv * m.J_point[1][j];
  }
  out.J_intrinsics.setZero(2, 4 + Model::kShape);
  out.J_intrinsics.topLeftCorner<2, 4>() << m.x, 0, 1, 0, 0, m.y, 0, 1;
  for (int j = 0; j < Model::kShape; ++j) {
    out.J_intrinsics.col(4 + j) << lens.fu * m.J_k[0][j], lens.fv * m.J_k[1][j];
  }
  return out;
}

// The undistorted radius whose radial distortion is `target`, by bisection to about 1e-9 relative:
// a start for Newton that is on the right side of the fold.
template <class Distortion>
double startRadius(const double* k, double target) {
  constexpr double kWidest = 1e4;  // tan of the angle to the axis
  double low = 0;
  double high = std::min(kWidest, std::sqrt(Distortion::squaredRadiusLimit(k)));
  if (Distortion::radial(k, high) <= target) return high * (1 - 1e-6);
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (Distortion::radial(k, middle) < target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// (x, y) with distort(x, y) == m.
template <class Distortion>
std::optional<Eigen::Vector2d> undistort(const double* k, const Eigen::Vector2d& m) {
  const double radius = m.norm();
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  if (radius > 0) x = m * (startRadius<Distortion>(k, radius) / radius);
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 50; ++i) {
    const auto d = Distortion::distort(k, x.x(), x.y());
    const Eigen::Vector2d miss(d.x - m.x(), d.y - m.y());
    const double size = miss.norm();
    const double rounding = 4e-15 * (1 + radius);
    if (size <= rounding || (size < 1e-12 && size >= last)) {
      if (x.squaredNorm() < Distortion::squaredRadiusLimit(k)) return x;
      return std::nullopt;
    }
    last = size;
    Eigen::Matrix2d J;
    J << d.J_xx, d.J_xy, d.J_yx, d.J_yy;
    x -= J.inverse() * miss;
    if (!x.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

template <class Distortion>
std::optional<Eigen::Vector3d> unprojectAs(Pinhole<Distortion>, const Intrinsics& camera,
                                           const Eigen::Vector2d& uv) {
  const Lens lens(camera);
  const Eigen::Vector2d m((uv.x() - lens.pu) / lens.fu, (uv.y() - lens.pv) / lens.fv);
  if (!m.allFinite()) return std::nullopt;
  const auto x = undistort<Distortion>(camera.distortion.data(), m);
  if (!x) return std::nullopt;
  return Eigen::Vector3d(x->x(), x->y(), 1).normalized();
}

std::string nameOf(const Intrinsics& camera) {
  return toString(camera.projection_model) + "-" + toString(camera.distortion_model);
}

}  // namespace

bool isCalibrationSupported(ProjectionModel projection, DistortionModel distortion) {
  return projection == ProjectionModel::kPinhole &&
         (distortion == DistortionModel::kRadtan || distortion == DistortionModel::kEquidistant);
}

AnyCameraModel cameraModelOf(const Intrinsics& camera) {
  if (!isCalibrationSupported(camera.projection_model, camera.distortion_model)) {
    throw InputError("camera model '" + nameOf(camera) +
                     "' is not supported; supported are pinhole-radtan and pinhole-equidistant; "
                     "recalibrate the camera with one of them");
  }
  if (camera.projection.size() != 4 || camera.distortion.size() != 4) {
    throw InputError("camera model '" + nameOf(camera) +
                     "' needs 4 projection and 4 distortion parameters, but " +
                     std::to_string(camera.projection.size()) + " and " +
                     std::to_string(camera.distortion.size()) +
                     " were given; give fu fv pu pv and the 4 coefficients");
  }
  if (camera.distortion_model == DistortionModel::kRadtan) return PinholeRadtan{};
  return PinholeEquidistant{};
}

std::optional<Eigen::Vector2d> project(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  return std::visit([&](auto model) { return projectAs(model, camera, p_C); },
                    cameraModelOf(camera));
}

std::optional<Projection> projectWithJacobians(const Intrinsics& camera,
                                               const Eigen::Vector3d& p_C) {
  return std::visit([&](auto model) { return projectWithJacobiansAs(model, camera, p_C); },
                    cameraModelOf(camera));
}

std::optional<Eigen::Vector3d> unproject(const Intrinsics& camera, const Eigen::Vector2d& uv) {
  return std::visit([&](auto model) { return unprojectAs(model, camera, uv); },
                    cameraModelOf(camera));
}

}  // namespace plumbline
