// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/comparison_record.h"

namespace plumbline {

/// Writes comparison.json, comparison.csv and records.sqlite into `out`, together or not at all;
/// see writeResultFolder().
void writeComparison(const ComparisonRecord& record, const std::string& out, bool report);

}  // namespace plumbline
