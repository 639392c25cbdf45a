// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/perturbation_record.h"

namespace plumbline {

/// Writes perturbation.json, perturbation.csv and records.sqlite (and, as asked, report.html) into
/// `out`, together or not at all; see writeResultFolder().
void writePerturbation(const PerturbationRecord& record, const std::string& out, bool report);

}  // namespace plumbline
