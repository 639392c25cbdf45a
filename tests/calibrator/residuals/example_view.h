// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"

namespace plumbline::test {

/// A tilted target, about a metre in front of the camera.
inline Transform examplePose() {
  return {expSO3({2.9, 0.3, -0.2}), Eigen::Vector3d(-0.3, 0.35, 1.1)};
}

/// The corners `camera` sees of the target, with Gaussian noise; `corner_count` first of the grid.
inline ImageView noisyView(const AprilGrid& target, const Intrinsics& camera, const Transform& T_CF,
                           int corner_count, double noise_px, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, noise_px);
  ImageView view;
  for (int id = 0; id < corner_count; ++id) {
    const Eigen::Vector2d p_F = target.corner(id);
    const auto uv = project(camera, T_CF * Eigen::Vector3d(p_F.x(), p_F.y(), 0));
    if (uv) view.corners.push_back({id, *uv + Eigen::Vector2d(noise(random), noise(random))});
  }
  return view;
}

}  // namespace plumbline::test
