// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "evaluate/compare/lint.h"

namespace plumbline::lint {

/// A finding's numbers: what was compared with which bound, and in which unit.
struct Measured {
  double value = 0;
  double threshold = 0;
  const char* unit = "-";
};

inline Finding bad(const std::string& rule, const std::string& evidence, const std::string& advice,
                   const Measured& measured) {
  return {rule,           VerdictLevel::kBad, evidence,     advice,
          measured.value, measured.threshold, measured.unit};
}

/// What one file says of itself.
std::vector<Finding> alone(const LintedCalibration& linted, const LintOptions& options);

/// What files of one rig say of each other; `suspects` (parallel) are those with a finding already,
/// which are left out.
std::vector<Finding> together(std::span<const LintedCalibration> calibrations,
                              const std::vector<bool>& suspects, const LintOptions& options);

/// How far two transforms are apart.
struct Distance {
  double rotation_rad = 0;
  double translation_m = 0;
};
Distance distanceBetween(const Transform& a, const Transform& b);

/// Whether `given` is the inverse of `reference` rather than `reference` itself.
bool isInverse(const Transform& given, const Transform& reference, const LintOptions& options);

}  // namespace plumbline::lint
