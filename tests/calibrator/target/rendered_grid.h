// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/image.h"

namespace plumbline::test {

/// A pinhole camera with two radial coefficients that looks at a target: p_C = R p_F + t.
struct TestCamera {
  int width = 752;
  int height = 480;
  double focal = 458;
  double k1 = -0.28;
  double k2 = 0.07;
  Eigen::Matrix3d R = Eigen::Vector3d(1, -1, -1).asDiagonal();  ///< facing the target, upright
  Eigen::Vector3d t = Eigen::Vector3d(0, 0, 1);

  /// Pixel of a point of the target's plane; empty behind the camera or where the distortion folds.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector2d& p_F) const;
  /// Normalised image coordinates of a pixel.
  Eigen::Vector2d undistort(const Eigen::Vector2d& uv) const;
};

/// Looks at the point `at_F` of the target from `distance` [m], the camera turned away from the
/// upright frontal view by `tilt_x`, `tilt_y` about the target's axes and `roll` about its own
/// [rad].
TestCamera lookAt(const Eigen::Vector2d& at_F, double distance, double tilt_x, double tilt_y,
                  double roll);

struct RenderOptions {
  double blur_px = 0.8;   ///< standard deviation of a Gaussian, beside the pixel's own square
  double noise_gray = 4;  ///< standard deviation of white noise
  double white = 200;
  double black = 40;
  int border_bits = 2;
  std::uint32_t seed = 1;  ///< of noise and background
};

/// The grid on white paper before a background of rectangles.
GrayImage renderGrid(const AprilGrid& grid, const TestCamera& camera,
                     const RenderOptions& options = {});

/// Background and noise only.
GrayImage renderClutter(int width, int height, const RenderOptions& options = {});

}  // namespace plumbline::test
