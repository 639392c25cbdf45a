// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/trajectory/page.h"

#include "report/html/page.h"
#include "report/html/trajectory/sections.h"

namespace plumbline {

using namespace html_internal;

std::string renderTrajectoryPage(const TrajectoryRecord& record) {
  // A verdict that was made has a headline.
  std::optional<Verdict> verdict;
  if (!record.verdict.headline.empty()) verdict = record.verdict;
  Page page{"Trajectories against ground truth",
            record.name,
            record.provenance,
            verdict,
            trajectoryCards(record),
            trajectorySections(record),
            std::nullopt};
  page.good_word = kCompleteWord;
  return renderPage(page);
}

}  // namespace plumbline
