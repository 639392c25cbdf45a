// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/image.h"

namespace plumbline {

/// Reads a PNG or JPEG file (told by its content, not its name) as 8-bit grey; colour becomes luma,
/// 16 bits become 8 as libpng maps them, transparency is laid on black. Throws InputError for
/// another format or a file that is cut or damaged. libpng and libjpeg-turbo directly: linking
/// OpenCV's imgcodecs, which brings GDAL and some hundred libraries, was measured to cost 70 ms and
/// 45 MB at every start.
GrayImage readGrayImage(const std::string& path);

/// Writes an 8-bit grey PNG under a temporary name and renames it. Throws InputError where it
/// cannot.
void writePng(const std::string& path, const GrayImage& image);

}  // namespace plumbline
