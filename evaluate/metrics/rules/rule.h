// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "evaluate/metrics/verdict.h"
#include "report/records/calibration_record.h"

namespace plumbline {

inline constexpr double kDegrees = 180 / std::numbers::pi;  ///< per radian

/// One rule of the verdict: its name, the unit of what it compares, and what to do where the level
/// is not good.
struct Rule {
  std::string name;
  std::string unit;
  Bound bound;
  std::string advice;
};

/// Where a value stands that should be small; NaN is bad.
VerdictLevel levelAbove(double value, const Bound& bound);

/// The finding of a rule: the threshold beside it is the bound crossed, or the nearer one if none
/// was; advice only where the level is not good.
Finding finding(const Rule& rule, VerdictLevel level, double value, std::string evidence);
/// The same for a value that is worse the larger, or the smaller, it is; NaN is bad.
Finding above(const Rule& rule, double value, std::string evidence);
Finding below(const Rule& rule, double value, std::string evidence);

/// The larger of formal and resampled standard deviation of a parameter.
struct Spread {
  double value = 0;
  std::string name;  ///< of the parameter; empty where there was none
  bool resampled = false;
};

/// The largest among the parameters whose name starts with `prefix` and, after the dot, is one of
/// `suffixes`; relative to the parameter's value where asked.
Spread largestSpread(const std::vector<ParameterEstimate>& estimates,
                     const std::vector<std::string>& suffixes, const std::string& prefix,
                     bool relative);
/// Which of the two it is, in words.
std::string kindOf(const Spread& spread);

/// part / whole; 0 of nothing.
double share(double part, double whole);

}  // namespace plumbline
