// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/image.h"
#include "calibrator/target/division_distortion.h"

namespace plumbline::test {

inline constexpr int kDrawnWidth = 48, kDrawnHeight = 44;

struct CornerLook {
  double blur_px = 0.8;
  double noise_gray = 0;
  Eigen::Vector2d light = Eigen::Vector2d::Zero();  ///< slope, relative to its value at p [1/px]
  DivisionDistortion lens = {};                     ///< the edges are straight before it
  double ink_px = 0;                                ///< by which the dark sectors grow on all sides
  double cover_px = 99;  ///< of grey, a half plane whose edge lies this far from p
};

/// Two lines through p, along the columns of `axes` there; sectors dark, light, dark, light. Drawn
/// sharp at an eighth of a pixel, blurred and averaged over each pixel: no model of blurred edges
/// is in it.
GrayImage drawCorner(const Eigen::Vector2d& p, const Eigen::Matrix2d& axes, const CornerLook& look);

}  // namespace plumbline::test
