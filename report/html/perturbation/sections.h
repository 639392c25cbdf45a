// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/html/section.h"
#include "report/records/perturbation_record.h"

namespace plumbline::html_internal {

inline constexpr const char* kShift = "imu-shift";

/// The cases of one kind, in their order.
struct CaseGroup {
  std::string kind;  ///< as in PerturbationCase
  std::vector<const PerturbationCase*> cases;
};

/// Injected time offsets against the errors of what was recovered.
Section basinSection(const PerturbationRecord& record, const std::vector<CaseGroup>& groups);

}  // namespace plumbline::html_internal
