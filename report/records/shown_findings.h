// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline {

/// How the evidence of a finding that was not judged begins: where its level `good` stands alone
/// (documents), no reader takes it for praise.
inline constexpr std::string_view kNotJudgedWords = "not judged: ";

/// The evidence for those who show `not judged` as the level: without these words.
std::string shownEvidence(const Finding& f);

/// findingsByCure(), with those together that one reason leaves not judged, which have no cure.
std::vector<std::vector<Finding>> shownFindings(const std::vector<Finding>& findings);

}  // namespace plumbline
