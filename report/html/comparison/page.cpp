// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html/comparison/sections.h"
#include "report/html/pages.h"
#include "report/html/trajectory/sections.h"

namespace plumbline {
namespace {

using namespace html_internal;

/// The largest over all parameters and calibrations, in combined standard deviations.
Card significanceCard(const ComparisonRecord& record) {
  // Below any significance: none was found.
  double most = -1;
  std::string name, label;
  for (const ComparedParameter& p : record.parameters) {
    for (std::size_t k = 0; k < p.significance.size() && k < record.calibrations.size(); ++k) {
      // The first calibration has none: differences are to it. NaN is above nothing.
      if (!p.significance[k] || !(*p.significance[k] > most)) continue;
      most = *p.significance[k];
      name = p.name;
      label = record.calibrations[k].label;
    }
  }
  if (most < 0) {
    return {"Most significant difference", "\u2013", "",
            "no pair of standard deviations to judge by"};
  }
  return {"Most significant difference", fmt::format("{:.1f}", most), "\u03c3",
          name + " of " + label};
}

std::vector<Card> cardsOf(const ComparisonRecord& record) {
  std::ptrdiff_t lint = 0;
  for (const ComparedCalibration& c : record.calibrations) {
    lint += std::ssize(c.lint) - std::ranges::count(c.lint, VerdictLevel::kGood, &Finding::level);
  }
  std::vector<Card> cards = {{"Calibrations", std::to_string(record.calibrations.size()), "",
                              record.calibrations.empty()
                                  ? ""
                                  : "differences relative to " + record.calibrations.front().label},
                             {"Convention faults", std::to_string(lint), "", "found in the files"},
                             significanceCard(record)};
  for (const CalibrationScore& s : record.scores) {
    // The others are in the table of scores.
    if (!s.problem.empty() || s.part != "all" || cards.size() >= 8) continue;
    cards.push_back({"RMSE, " + s.label, fmt::format("{:.4f}", s.reprojection.rmse_px), "px",
                     "on " + s.session + (s.held_out ? ", held out" : "")});
  }
  return cards;
}

std::vector<Section> sectionsOf(const ComparisonRecord& record) {
  std::vector<Section> sections = {
      calibrationsSection(record),    comparedParametersSection(record),
      sessionEstimateSection(record), transformsSection(record),
      offsetsSection(record),         scoresSection(record),
      entropySection(record),         differenceSection(record),
      uncertaintySection(record)};
  if (!record.trajectories) return sections;
  for (Section& section : trajectorySections(*record.trajectories)) {
    section.title = "Trajectories: " + section.title;
    sections.push_back(std::move(section));
  }
  return sections;
}

}  // namespace

std::string renderComparisonPage(const ComparisonRecord& record) {
  return renderPage({"Comparison of calibrations", record.name, record.provenance, record.verdict,
                     cardsOf(record), sectionsOf(record), record.assumptions});
}

}  // namespace plumbline
