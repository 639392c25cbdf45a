// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace plumbline::html_internal {

/// `value` with as many decimals as show two digits of `std` ("458.654" for 0.080); six significant
/// digits where std is not a positive number.
std::string withPrecisionOf(double value, double std);

/// Two significant digits ("0.080", "1.2e-05").
std::string twoDigits(double value);

/// Thousands apart by thin spaces ("358 210").
std::string grouped(std::size_t count);

/// A quantity in the unit in which people read it: m as mm, rad as degrees, s as ms.
struct ReadableUnit {
  std::string unit;
  double factor = 1;
};
ReadableUnit readable(const std::string& unit);

}  // namespace plumbline::html_internal
