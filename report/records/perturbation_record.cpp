// SPDX-License-Identifier: BSD-3-Clause
#include "report/records/perturbation_record.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

std::optional<std::size_t> largestOtherChange(const std::vector<std::string>& parameters,
                                              const PerturbationCase& c) {
  std::optional<std::size_t> worst;
  for (std::size_t i = 0; i < std::min(parameters.size(), c.changes_sigma.size()); ++i) {
    if (parameters[i] == "time_offset") continue;
    // What has no value after the change has moved further than any number tells.
    if (i < c.changes.size() && !std::isfinite(c.changes[i])) return i;
    // Without a deviation of the base there is nothing to count in.
    if (!std::isfinite(c.changes_sigma[i])) continue;
    if (!worst || std::abs(c.changes_sigma[i]) > std::abs(c.changes_sigma[*worst])) worst = i;
  }
  return worst;
}

bool hasOffset(const PerturbationRecord& record) {
  return std::ranges::find(record.parameters, "time_offset") != record.parameters.end();
}

}  // namespace plumbline
