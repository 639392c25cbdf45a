// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/image.h"

namespace plumbline {

/// A grey image as the bytes of a JPEG file. `quality` 1 to 100. The image is not empty. Throws
/// InputError where libjpeg refuses it.
std::string encodeJpeg(const GrayImage& image, int quality);

}  // namespace plumbline
