// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/camera/camera.h"

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/camera/camera_dispatch.h"

namespace plumbline {
namespace {

// Calls visit(Model{}) for every model, so that AnyCameraModel is the one list of them.
template <class Visit, CameraModel... Models>
void forEach(const std::variant<Models...>& /*any*/, const Visit& visit) {
  (visit(Models{}), ...);
}

std::optional<AnyCameraModel> find(ProjectionModel projection, DistortionModel distortion) {
  std::optional<AnyCameraModel> found;
  forEach(AnyCameraModel(), [&]<class Model>(Model model) {
    if (Model::kProjection == projection && Model::kDistortion == distortion) found = model;
  });
  return found;
}

std::string nameOf(ProjectionModel projection, DistortionModel distortion) {
  return toString(projection) + "-" + toString(distortion);
}

std::string supportedNames() {
  std::string names;
  forEach(AnyCameraModel(), [&]<class Model>(Model) {
    names += (names.empty() ? "" : ", ") + nameOf(Model::kProjection, Model::kDistortion);
  });
  return names;
}

// uv = (fu m_x + pu, fv m_y + pv) for every model, m its image of the point at unit focal length.
template <CameraModel Model>
std::optional<Eigen::Vector2d> projectAs(Model, const CameraValues& lens,
                                         const Eigen::Vector3d& p_C) {
  const double* k = lens.k.data();
  // Before image(), which does not look whether the point can be seen.
  if (!Model::isInDomain(k, p_C.x(), p_C.y(), p_C.z())) return std::nullopt;
  const auto m = Model::image(k, p_C.x(), p_C.y(), p_C.z());
  return Eigen::Vector2d(lens.fu * m.x + lens.pu, lens.fv * m.y + lens.pv);
}

// d uv = diag(fu, fv) dm + (m_x dfu, m_y dfv) + (dpu, dpv).
template <CameraModel Model>
std::optional<Projection> projectWithJacobiansAs(Model, const Intrinsics& camera,
                                                 const Eigen::Vector3d& p_C, bool beyond_fold) {
  const CameraValues lens(camera);
  const double* k = lens.k.data();
  const bool defined = beyond_fold ? Model::isProjectable(k, p_C.x(), p_C.y(), p_C.z())
                                   : Model::isInDomain(k, p_C.x(), p_C.y(), p_C.z());
  if (!defined) return std::nullopt;
  const auto m = Model::image(k, p_C.x(), p_C.y(), p_C.z());
  Projection out;
  out.uv << lens.fu * m.x + lens.pu, lens.fv * m.y + lens.pv;
  for (int j = 0; j < 3; ++j) {
    out.J_point.col(j) << lens.fu * m.J_point[0][j], lens.fv * m.J_point[1][j];
  }
  out.J_intrinsics.setZero(2, 4 + Model::kShape);
  // Rows u, v by fu, fv, pu, pv.
  out.J_intrinsics.middleCols<4>(Model::kLeading) << m.x, 0, 1, 0, 0, m.y, 0, 1;
  for (int j = 0; j < Model::kShape; ++j) {
    out.J_intrinsics.col(shapeColumn<Model>(j)) << lens.fu * m.J_k[0][j], lens.fv * m.J_k[1][j];
  }
  return out;
}

template <CameraModel Model>
std::optional<Eigen::Vector3d> unprojectAs(Model, const Intrinsics& camera,
                                           const Eigen::Vector2d& uv) {
  const CameraValues lens(camera);
  const auto ray =
      Model::ray(lens.k.data(), (uv.x() - lens.pu) / lens.fu, (uv.y() - lens.pv) / lens.fv);
  if (!ray) return std::nullopt;
  return Eigen::Vector3d((*ray)[0], (*ray)[1], (*ray)[2]).normalized();
}

}  // namespace

AnyCameraModel cameraModelOf(const Intrinsics& camera) {
  const auto model = find(camera.projection_model, camera.distortion_model);
  if (!model) {
    throw InputError(fmt::format(
        "camera model '{}' is not supported; supported are: {}; recalibrate the camera with one of "
        "them",
        nameOf(camera.projection_model, camera.distortion_model), supportedNames()));
  }
  const auto [projection, distortion] = std::visit(
      []<class Model>(Model) {
        return std::pair(4 + Model::kLeading, Model::kShape - Model::kLeading);
      },
      *model);
  if (camera.projection.size() != projection || camera.distortion.size() != distortion) {
    throw InputError(fmt::format(
        "camera model '{}' needs {} projection and {} distortion parameters, but {} and {} were "
        "given; give the projection's own, then fu fv pu pv, and the distortion's coefficients",
        nameOf(camera.projection_model, camera.distortion_model), projection, distortion,
        camera.projection.size(), camera.distortion.size()));
  }
  return *model;
}

std::optional<Eigen::Vector2d> project(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  return std::visit([&](auto model) { return projectAs(model, CameraValues(camera), p_C); },
                    cameraModelOf(camera));
}

std::vector<std::optional<Eigen::Vector2d>> project(const Intrinsics& camera,
                                                    std::span<const Eigen::Vector3d> p_C) {
  std::vector<std::optional<Eigen::Vector2d>> uv;
  uv.reserve(p_C.size());
  // One visit for all: finding the model of each point would take longer than its projection.
  std::visit(
      [&](auto model) {
        const CameraValues lens(camera);
        for (const Eigen::Vector3d& p : p_C) uv.push_back(projectAs(model, lens, p));
      },
      cameraModelOf(camera));
  return uv;
}

std::optional<Projection> projectWithJacobians(const Intrinsics& camera,
                                               const Eigen::Vector3d& p_C) {
  return std::visit([&](auto model) { return projectWithJacobiansAs(model, camera, p_C, false); },
                    cameraModelOf(camera));
}

std::optional<Projection> projectBeyondFold(const Intrinsics& camera, const Eigen::Vector3d& p_C) {
  return std::visit([&](auto model) { return projectWithJacobiansAs(model, camera, p_C, true); },
                    cameraModelOf(camera));
}

double pixelsPerRadian(const Intrinsics& camera) {
  // At depth 1 on the axis a step along X is an angle, to first order.
  const auto axis = projectWithJacobians(camera, {0, 0, 1});
  return axis ? axis->J_point(0, 0) : camera.projection.tail<4>()[0];
}

std::optional<Eigen::Vector3d> unproject(const Intrinsics& camera, const Eigen::Vector2d& uv) {
  return std::visit([&](auto model) { return unprojectAs(model, camera, uv); },
                    cameraModelOf(camera));
}

}  // namespace plumbline
