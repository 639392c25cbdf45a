// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/html/figure.h"
#include "report/records/perturbation_record.h"

namespace plumbline::html_internal {

/// The cases of one kind, in their order.
struct CaseGroup {
  std::string kind;  ///< as in PerturbationCase
  std::vector<const PerturbationCase*> cases;
};
std::vector<CaseGroup> groupedCases(const PerturbationRecord& record);

/// "Shifted IMU stamps" for "imu-shift"; a kind without words of its own stands as it is.
std::string titleOf(const std::string& kind);
/// "+10 ms", "×2", with the seed of random ones.
std::string labelOf(const PerturbationCase& c);

/// Injected offset against |recovered - injected - base| on decades, failures along the top.
Figure basinFigure(const PerturbationRecord& record, const CaseGroup& shifts);

/// Cases down, parameters across, changes in standard deviations of the base. `index` tells the
/// figures of a page apart: a kind read from a store may be any text.
Figure changeFigure(const PerturbationRecord& record, const CaseGroup& group, std::size_t index);

}  // namespace plumbline::html_internal
