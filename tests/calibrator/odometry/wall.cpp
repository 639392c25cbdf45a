// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/odometry/wall.h"

#include <cmath>
#include <cstdint>

#include "calibrator/base/transform.h"

namespace plumbline::test {
namespace {

/// A number in [0, 1) for every node of a grid, as if drawn.
double drawn(int i, int j) {
  auto x = static_cast<std::uint32_t>(i) * 374761393U + static_cast<std::uint32_t>(j) * 668265263U;
  x = (x ^ (x >> 13U)) * 1274126177U;
  return static_cast<double>((x ^ (x >> 16U)) & 0xffffU) / 65536;
}

double greyOf(const Eigen::Vector2d& p_m) {
  constexpr double kNode_m = 0.06;
  const double u = p_m.x() / kNode_m, v = p_m.y() / kNode_m;
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  const auto ease = [](double s) { return s * s * (3 - 2 * s); };
  const double a = ease(u - i), b = ease(v - j);
  const double top = (1 - a) * drawn(i, j) + a * drawn(i + 1, j);
  const double bottom = (1 - a) * drawn(i, j + 1) + a * drawn(i + 1, j + 1);
  return 20 + 210 * ((1 - b) * top + b * bottom);
}

Transform poseOf(const RigModel& rig, const Transform& T_WC0, int camera) {
  return T_WC0 * (rig.T_SC[0].inverse() * rig.T_SC[static_cast<std::size_t>(camera)]);
}

/// A pinhole's own inverse: the library's is not what places the wall.
Eigen::Vector2d onWall(const Eigen::VectorXd& lens, const Transform& T_WC,
                       const Eigen::Vector2d& uv) {
  const Eigen::Vector3d ray =
      T_WC.R * Eigen::Vector3d((uv.x() - lens[2]) / lens[0], (uv.y() - lens[3]) / lens[1], 1);
  return (T_WC.t + (kWall_m - T_WC.t.z()) / ray.z() * ray).head<2>();
}

}  // namespace

RigModel wallRig() {
  RigModel rig;
  Intrinsics lens;
  lens.projection_model = ProjectionModel::kPinhole;
  lens.distortion_model = DistortionModel::kNone;
  lens.projection = Eigen::Vector4d(180, 180, 119.5, 89.5);
  lens.distortion.resize(0);
  lens.resolution = {240, 180};
  rig.cameras = {lens, lens};
  const Eigen::Matrix3d R_SC = expSO3({0.3, -1.2, 0.7});
  const Eigen::Vector3d t_SC0(0.02, 0.05, -0.01);
  rig.T_SC = {{R_SC, t_SC0}, {R_SC, t_SC0 + R_SC * Eigen::Vector3d(0.1, 0, 0)}};
  return rig;
}

Eigen::Vector2d onWall(const RigModel& rig, const Transform& T_WC0, int camera,
                       const Eigen::Vector2d& uv) {
  return onWall(rig.cameras[static_cast<std::size_t>(camera)].projection,
                poseOf(rig, T_WC0, camera), uv);
}

GrayImage seenFrom(const RigModel& rig, const Transform& T_WC0, int camera) {
  const Transform T_WC = poseOf(rig, T_WC0, camera);
  const Intrinsics& lens = rig.cameras[static_cast<std::size_t>(camera)];
  GrayImage image(lens.resolution.width, lens.resolution.height);
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) {
      const double grey = greyOf(onWall(lens.projection, T_WC, Eigen::Vector2d(u, v)));
      image.at(u, v) = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
  return image;
}

}  // namespace plumbline::test
