// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "calibrator/base/image.h"

namespace plumbline {

/// Convolves a width x height image (row by row) with a Gaussian of sigma_px, cut off at 4 sigma
/// and normalised; beyond the border the outermost pixels repeat. 0: unchanged.
std::vector<float> gaussianBlur(const std::vector<float>& light, int width, int height,
                                double sigma_px);

/// Adds Gaussian noise and rounds to grey levels. The noise of a pixel depends on `seed`, `image`
/// and its place only.
GrayImage exposeSensor(const std::vector<float>& light, int width, int height, double noise_sigma,
                       std::uint64_t seed, std::uint64_t image);

}  // namespace plumbline
