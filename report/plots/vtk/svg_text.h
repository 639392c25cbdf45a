// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace plumbline::internal {

/// Escapes &, <, > and quotes for XML text and attributes.
std::string escapeXml(const std::string& text);

/// A coordinate to a tenth of a pixel, without trailing zeros ("12", "12.5", "-0.1").
std::string pixel(double value);

/// The same to a hundredth: of data that are zoomed.
std::string finePixel(double value);

/// "x,y x,y ..." of page points x y x y, each as `write` has it.
std::string pointList(const std::vector<double>& points, std::string (*write)(double) = pixel);

/// A line's points (page pixels, x y x y) thinned to what can be seen. Where x never falls: of each
/// half pixel the first, the lowest, the highest and the last. Otherwise: equal neighbours (to a
/// tenth of a pixel) are merged. Short lines stay as they are.
std::vector<double> thinLine(const std::vector<double>& points);

}  // namespace plumbline::internal
