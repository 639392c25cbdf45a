// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "report/records/calibration_record.h"

namespace plumbline {

// The parts that the JSON documents of all commands share; fields as in docs/calibration_json.md.

nlohmann::ordered_json errorsJson(const ErrorStatistics& errors);  ///< all but the count
nlohmann::ordered_json noiseJson(const ImuNoise& noise);
nlohmann::ordered_json verdictJson(const Verdict& verdict);
nlohmann::ordered_json assumptionsJson(const Assumptions& assumptions);
nlohmann::ordered_json provenanceJson(const Provenance& provenance);

}  // namespace plumbline
