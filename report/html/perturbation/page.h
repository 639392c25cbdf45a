// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/perturbation_record.h"

namespace plumbline {

/// One self-contained HTML page of a perturbation study: verdict and findings, key figures, the
/// convergence basin of injected time offsets, the change of every parameter in standard deviations
/// of the base, a table of all cases (failed ones with their problem), the base's parameters,
/// provenance. Equal records give equal bytes. One thread at a time (see report/plots/svg.h).
std::string renderPerturbationPage(const PerturbationRecord& record);

}  // namespace plumbline
