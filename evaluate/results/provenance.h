// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline {

/// Version, command, options and the present time (UTC); input and hash are the workflow's. The
/// time is SOURCE_DATE_EPOCH where that variable is set, so that results can be reproduced byte for
/// byte.
Provenance makeProvenance(const std::string& command,
                          std::vector<std::pair<std::string, std::string>> options);

}  // namespace plumbline
