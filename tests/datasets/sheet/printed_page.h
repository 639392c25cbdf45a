// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

#include "calibrator/base/image.h"

namespace plumbline {

/// Width and height [mm] of the page of a PDF that cairo wrote.
Eigen::Vector2d pageSize(const std::string& pdf);

/// What is filled on it as a printer would set it, `pixels_per_mm` of them: each closed path as the
/// rectangle around it. Lines and text are left out.
GrayImage printedPage(const std::string& pdf, double pixels_per_mm);

}  // namespace plumbline
