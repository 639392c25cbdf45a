// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/perturbation_record.h"

namespace plumbline {

/// perturbation.csv: one row a case, base first; the changes of all parameters in the last columns.
std::string perturbationTable(const PerturbationRecord& record);

/// The table for a terminal, with the verdict's findings below it.
std::string perturbationSummary(const PerturbationRecord& record);

}  // namespace plumbline
