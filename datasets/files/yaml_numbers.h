// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

namespace plumbline {

/// The shortest text that reads back to the same double, with a decimal point even before an
/// exponent, as YAML 1.1 wants it of a number ("1.0e-05").
std::string yamlNumber(double value);

/// "[1.0, 2.5]".
std::string yamlList(const Eigen::VectorXd& values);

}  // namespace plumbline
