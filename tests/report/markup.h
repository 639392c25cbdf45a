// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace plumbline::test {

/// What is wrong with an XML text (tags that do not nest, bare '<' or '&', repeated attributes of
/// the same name are not looked for); empty when nothing is.
std::string faultOfXml(const std::string& xml);

/// Every value of an attribute, in order of appearance.
std::vector<std::string> attributes(const std::string& xml, const std::string& name);

/// The numbers in a text, in order.
std::vector<double> numbers(const std::string& text);

/// data-ax of a plot and the pixel on which a value must lie by it.
struct AxisMapping {
  std::array<double, 8> a{};
  explicit AxisMapping(const std::string& svg);
  double pixelX(double x) const { return a[4] + (x - a[0]) / (a[1] - a[0]) * (a[5] - a[4]); }
  double pixelY(double y) const { return a[6] + (y - a[2]) / (a[3] - a[2]) * (a[7] - a[6]); }
};

}  // namespace plumbline::test
