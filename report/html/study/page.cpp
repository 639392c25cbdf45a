// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html/pages.h"
#include "report/html/study/sections.h"

namespace plumbline {
namespace {

using namespace html_internal;

std::vector<Card> cardsOf(const StudyRecord& record) {
  const auto& sessions = record.sessions;
  const auto failed = std::ranges::count(sessions, StudyStatus::kFailed, &StudySession::status);
  // Whoever gave up may still have a calibration: the two counts overlap.
  const auto gave_up = std::ranges::count(sessions, false, &StudySession::finished);
  std::vector<Card> cards = {
      {"Sessions", std::to_string(sessions.size()), "",
       fmt::format("{} calibrated, {} failed", std::ssize(sessions) - failed, failed)},
      {"Sessions given up", std::to_string(gave_up), "",
       fmt::format("limit {:g} s", record.limit_s)}};
  for (const StudyMethod& m : record.statistics.methods) {
    if (!m.median_held_out_px) continue;
    // The median is over those with a score, so that is the number beside it.
    const auto scored = std::ranges::count_if(sessions, [&](const StudySession& s) {
      return s.method == m.method && s.held_out_rmse_px.has_value();
    });
    cards.push_back({"Held-out RMSE, " + m.method, fmt::format("{:.4f}", *m.median_held_out_px),
                     "px",
                     scored == 1 ? "one session" : fmt::format("median of {} sessions", scored)});
  }
  if (!record.nights.empty()) {
    cards.push_back({"Alarms", std::to_string(record.alarms.size()), "",
                     fmt::format("night {}", record.nights.back().night)});
  }
  return cards;
}

}  // namespace

std::string renderStudyPage(const StudyRecord& record) {
  return renderPage(
      {.kicker = record.rig.empty() ? "User study" : "User study, rig " + record.rig,
       .name = record.name,
       .provenance = record.provenance,
       .verdict = record.verdict,
       .cards = cardsOf(record),
       .sections = {resultsSection(record), orderSection(record), timeSection(record),
                    trajectorySection(record), heldOutSection(record), entropySection(record),
                    offsetSection(record), perturbationSection(record), spreadSection(record),
                    boardSection(record), othersSection(record), nightsSection(record),
                    failuresSection(record), sessionsSection(record)},
       .assumptions = {},
       // That every step is done praises no method.
       .good_word = "complete"});
}

}  // namespace plumbline
