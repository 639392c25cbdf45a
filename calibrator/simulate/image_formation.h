// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/image.h"

namespace plumbline {

/// Rays through the corners (x - 0.5, y - 0.5) of all pixels, row by row, width + 1 to a row; zero
/// where the camera's model has none.
std::vector<Eigen::Vector3f> cornerRays(const Intrinsics& camera);

/// 1 - vignetting (r / r_corner)^2 of every pixel, r from the image's centre.
std::vector<float> vignettingGain(const Resolution& size, double vignetting);

/// Convolves a width x height image (row by row) with a Gaussian of sigma_px, cut off at 4 sigma
/// and normalised; beyond the border the outermost pixels repeat. 0: unchanged.
std::vector<float> gaussianBlur(const std::vector<float>& light, int width, int height,
                                double sigma_px);

/// Adds Gaussian noise and rounds to grey levels. The noise of a pixel depends on `seed`, `image`
/// and its place only.
GrayImage exposeSensor(const std::vector<float>& light, int width, int height, double noise_sigma,
                       std::uint64_t seed, std::uint64_t image);

}  // namespace plumbline
