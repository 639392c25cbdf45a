// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/view_errors.h"

#include "calibrator/camera/camera_dispatch.h"

namespace plumbline {
namespace {

constexpr double kFarOff = 1e5;  // [px]

template <CameraModel Model>
std::vector<Eigen::Vector2d> viewErrorsAs(Model, const Intrinsics& camera, const Transform& T_CF,
                                          const PackedView& view) {
  std::vector<Eigen::Vector2d> errors(static_cast<std::size_t>(view.count));
  const CameraValues lens(camera);
  const double* k = lens.k.data();
  for (int i = 0; i < view.count; ++i) {
    const Eigen::Vector3d p = T_CF.R.col(0) * view.x[i] + T_CF.R.col(1) * view.y[i] + T_CF.t;
    Eigen::Vector2d& e = errors[static_cast<std::size_t>(i)];
    if (!Model::isProjectable(k, p.x(), p.y(), p.z())) {
      e << kFarOff, 0;
      continue;
    }
    const auto m = Model::image(k, p.x(), p.y(), p.z());
    e << view.u[i] - (lens.fu * m.x + lens.pu), view.v[i] - (lens.fv * m.y + lens.pv);
  }
  return errors;
}

}  // namespace

std::vector<Eigen::Vector2d> viewErrors(const Intrinsics& camera, const Transform& T_CF,
                                        const PackedView& view) {
  return std::visit([&](auto model) { return viewErrorsAs(model, camera, T_CF, view); },
                    cameraModelOf(camera));
}

}  // namespace plumbline
