// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "report/plots/svg.h"

namespace plumbline {
namespace {

/// The smallest of 1, 2, 5 times a power of ten that is not below `rough`.
double roundStep(double rough) {
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

std::string label(double value, double step, double largest) {
  // Beyond these the zeros would take the axis' room. As many digits as lie between the value and
  // the step tell neighbours apart.
  if (largest >= 1e6 || largest < 1e-4) {
    if (value == 0) return "0";
    const int digits = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9)) -
                       static_cast<int>(std::floor(std::log10(step) + 1e-9));
    return fmt::format("{:.{}e}", value, std::max(0, digits));
  }
  // The digits of the step; the margin is for steps such as 0.1, whose logarithm may round below
  // -1.
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::vector<AxisTick> roundTicks(const Range& range, int target) {
  assert(range.min < range.max && target >= 2);
  // Round steps are at most 2.5 times apart, so that 1.5 target ticks become 0.6 target at the
  // worst.
  const double step = roundStep((range.max - range.min) / (1.5 * target));
  const double largest = std::max(std::abs(range.min), std::abs(range.max));
  // Ticks are whole multiples of the step, counted in integers: a running sum would drift off 0.
  // The margin keeps a tick that rounding puts just beyond an end of the axis.
  const auto first = static_cast<long long>(std::ceil(range.min / step - 1e-9));
  const auto last = static_cast<long long>(std::floor(range.max / step + 1e-9));
  std::vector<AxisTick> ticks;
  for (long long i = first; i <= last; ++i) {
    const double position = static_cast<double>(i) * step;
    ticks.push_back({position, label(position, step, largest)});
  }
  return ticks;
}

Range rangeOf(const std::vector<const std::vector<double>*>& columns, double margin) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const auto* column : columns) {
    for (const double value : *column) {
      if (!std::isfinite(value)) continue;
      range.min = std::min(range.min, value);
      range.max = std::max(range.max, value);
    }
  }
  if (range.min > range.max) return {0, 1};
  double span = range.max - range.min;
  if (span <= 1e-12 * std::max(std::abs(range.min), std::abs(range.max)) || span == 0) {
    // All values are equal, or differ by rounding alone, which no axis should magnify.
    span = range.max == 0 ? 1 : std::abs(range.max);
    return {range.min - span / 2, range.max + span / 2};
  }
  return {range.min - margin * span, range.max + margin * span};
}

}  // namespace plumbline
