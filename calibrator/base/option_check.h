// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {

/// The text without the sign of numbers that are all zeros: "-0.000" becomes "0.000", also with the
/// minus sign U+2212. Words, ranges and numbers with an exponent or any other digit stay: "cam-0",
/// "1-0", "-0.5", "-0e3".
std::string withoutNegativeZeros(std::string_view text);

/// For the check() of options: throws InputError "FIELD is VALUE; expected RULE" unless `holds`.
/// Write the condition so that NaN does not fulfil it: value > 0, not !(value <= 0).
template <class T>
void requireOption(bool holds, const char* field, const T& value, const char* rule) {
  if (!holds) throw InputError(fmt::format("{} is {}; expected {}", field, value, rule));
}

/// The same for a value that must lie in [low, high].
inline void requireWithin(double low, double high, const char* field, double value) {
  if (value >= low && value <= high) return;
  throw InputError(
      fmt::format("{} is {}; expected a value from {} to {}", field, value, low, high));
}

/// For one that must be finite and at least `least`.
inline void requireAtLeast(double least, const char* field, double value) {
  if (value >= least && std::isfinite(value)) return;
  throw InputError(fmt::format("{} is {}; expected {} or more", field, value, least));
}

/// For one that must be finite and positive.
inline void requirePositive(const char* field, double value) {
  requireOption(value > 0 && std::isfinite(value), field, value, "a positive number");
}

}  // namespace plumbline
