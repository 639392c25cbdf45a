// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "report/plots/base64.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// `value` with as many decimals as show two digits of `std` ("458.654" for 0.080); six significant
/// digits where std is not a positive number.
std::string withPrecisionOf(double value, double std);

/// Two significant digits ("0.080", "1.2e-05").
std::string twoDigits(double value);

/// Seconds in the unit that leaves one to three digits before the point ("13.6 \u00b5s"), with as
/// many decimals as show two digits of `std`; three significant digits where std is not positive.
std::string scaledSeconds(double seconds, double std);

/// Thousands apart by thin spaces ("358 210").
std::string grouped(std::size_t count);

/// Whether a noise check tells a density. A group of less redundancy than the check moves
/// (kLeastRedundancy in camera_imu/noise.cpp) keeps a factor of 1, which says nothing.
inline bool tellsDensity(const ImuNoiseCheck& check) { return check.redundancy >= 10; }

/// A quantity in the unit in which people read it: m as mm, rad as degrees, s as ms.
struct ReadableUnit {
  std::string unit;
  double factor = 1;
};
ReadableUnit readable(const std::string& unit);

/// Index of the name; their number where it is not among them.
inline std::size_t placeOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

/// The names of the rows, each once, in the order of their first.
std::vector<std::string> distinct(const auto& rows, const auto& name) {
  std::vector<std::string> names;
  for (const auto& row : rows) {
    if (placeOf(names, name(row)) == names.size()) names.push_back(name(row));
  }
  return names;
}

/// JSON as it may stand in a script element: nothing in it looks like the element's end.
std::string scriptJson(const std::string& json);

using internal::base64;

/// Rounded to a whole number, and cut where 16 bits end: a cell of data in base64.
inline std::int16_t shortCell(double value) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -32767.0, 32767.0)));
}

}  // namespace plumbline::html_internal
