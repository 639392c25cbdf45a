// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/trajectory/page.h"

#include "report/html/page.h"
#include "report/html/trajectory/sections.h"

namespace plumbline {

using namespace html_internal;

std::string renderTrajectoryPage(const TrajectoryRecord& record) {
  std::optional<Verdict> verdict;
  if (!record.verdict.findings.empty()) verdict = record.verdict;
  return renderPage({"Trajectories against ground truth", record.name, record.provenance, verdict,
                     trajectoryCards(record), trajectorySections(record), std::nullopt});
}

}  // namespace plumbline
