// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/yaml_numbers.h"

#include <algorithm>

#include <fmt/format.h>

namespace plumbline {

std::string yamlNumber(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".ni") != std::string::npos) return text;  // has one, or nan, inf
  return text.insert(std::min(text.find('e'), text.size()), ".0");
}

std::string yamlList(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + yamlNumber(value);
  return "[" + text + "]";
}

}  // namespace plumbline
