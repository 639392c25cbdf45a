// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/lint.h"

#include <utility>

#include "evaluate/compare/lint/rules.h"

namespace plumbline {

std::vector<Finding> lintCalibrations(std::span<const LintedCalibration> calibrations,
                                      const LintOptions& options) {
  std::vector<Finding> found;
  std::vector<bool> suspects;
  for (const LintedCalibration& linted : calibrations) {
    std::vector<Finding> own = lint::alone(linted, options);
    // A file with a fault of its own contradicts all others by it: it is not held against them.
    suspects.push_back(!own.empty());
    append(found, std::move(own));
  }
  append(found, lint::together(calibrations, suspects, options));
  return found;
}

}  // namespace plumbline
