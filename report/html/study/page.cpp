// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/study/page.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html/page.h"
#include "report/html/study/tables.h"

namespace plumbline {
namespace {

using namespace html_internal;

std::vector<Card> cardsOf(const StudyRecord& record) {
  const auto count = [&](const auto& holds) {
    return std::count_if(record.sessions.begin(), record.sessions.end(), holds);
  };
  const auto failed = count([](const StudySession& s) { return s.status == StudyStatus::kFailed; });
  const auto gave_up = count([](const StudySession& s) { return !s.finished; });
  return {{"Sessions", std::to_string(record.sessions.size()), "",
           fmt::format("{} calibrated, {} failed",
                       count([](const StudySession& s) { return s.status == StudyStatus::kOk; }),
                       failed)},
          {"Gave up", std::to_string(gave_up), "", fmt::format("limit {:g} s", record.limit_s)}};
}

}  // namespace

std::string renderStudyPage(const StudyRecord& record) {
  return renderPage({"Study",
                     record.name,
                     record.provenance,
                     record.verdict,
                     cardsOf(record),
                     {methodsSection(record), failuresSection(record), sessionsSection(record)},
                     {}});
}

}  // namespace plumbline
