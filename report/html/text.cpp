// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "report/html/section.h"

namespace plumbline::html_internal {

std::string withPrecisionOf(double value, double std) {
  if (!(std > 0) || !std::isfinite(std) || !std::isfinite(value)) {
    return fmt::format("{:.6g}", value);
  }
  // Of the digits of a double no more than 15 after the point mean anything.
  // One decimal more than the place of the deviation's first digit: three for 0.080, none for 12.
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(std))), 0, 15);
  return fmt::format("{:.{}f}", value, decimals);
}

Cell orDash(const std::optional<double>& value, double factor, const char* format) {
  if (!value) return number(kDash);
  return number(fmt::format(fmt::runtime(format), factor * *value));
}

std::string twoDigits(double value) {
  if (!(value > 0) || !std::isfinite(value)) return "\u2013";
  if (value < 1e-4 || value >= 1e4) return fmt::format("{:.1e}", value);
  return withPrecisionOf(value, value);
}

std::string scaledSeconds(double seconds, double std) {
  // By the larger of the two: next to 0 the deviation gives the unit.
  const double size = std::max(std::abs(seconds), std::isfinite(std) ? std : 0);
  const auto [factor, unit] = size >= 1 || !(size > 0) ? std::pair(1.0, "s")
                              : size >= 1e-3           ? std::pair(1e3, "ms")
                              : size >= 1e-6           ? std::pair(1e6, "\u00b5s")
                                                       : std::pair(1e9, "ns");
  if (std > 0 && std::isfinite(std)) {
    return fmt::format("{} {}", withPrecisionOf(factor * seconds, factor * std), unit);
  }
  return fmt::format("{:.3g} {}", factor * seconds, unit);
}

std::string grouped(std::size_t count) {
  std::string text = std::to_string(count);
  // Counted from the end, where the groups begin.
  for (std::size_t i = text.size(); i > 3;) {
    i -= 3;
    text.insert(i, "\u2009");
  }
  return text;
}

ReadableUnit readable(const std::string& unit) {
  if (unit == "m") return {"mm", 1e3};
  if (unit == "rad") return {"\u00b0", kDegrees};
  if (unit == "s") return {"ms", 1e3};
  return {unit, 1};
}

// Appended: replaced in place, many of them would take the square of the length.
std::string scriptJson(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    // As JSON escapes it: "</script" would end the element.
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace plumbline::html_internal
