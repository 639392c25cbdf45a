// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/study/tables.h"

#include <fmt/format.h>

#include "report/html/text.h"

namespace plumbline::html_internal {
namespace {

Cell orDash(const std::optional<double>& value, double factor, const char* format) {
  if (!value) return number(kDash);
  return number(fmt::format(fmt::runtime(format), factor * *value));
}

Cell linkTo(const StudySession& s) { return {s.name, Cell::Kind::kTight, {}, s.page}; }

Cell offsetCell(const StudySession& s) {
  if (!s.time_offset_s) return number(kDash);
  return number(withPrecisionOf(1e3 * *s.time_offset_s, 1e3 * s.time_offset_std_s.value_or(0)));
}

Cell verdictCell(const StudySession& s) {
  if (s.status == StudyStatus::kFailed) {
    return {"failed: " + s.message, Cell::Kind::kText, VerdictLevel::kBad};
  }
  return {s.verdict_sentence.empty() ? toString(s.verdict) : s.verdict_sentence, Cell::Kind::kText,
          s.verdict};
}

}  // namespace

Section methodsSection(const StudyRecord& record) {
  Table table{{{"Method"},
               {"Sessions", kNumber},
               {"Calibrated", kNumber},
               {"Gave up", kNumber},
               {"Good", kNumber},
               {"Caution", kNumber},
               {"Bad", kNumber},
               {"Median time [s]", kNumber},
               {"Median held-out RMSE [px]", kNumber},
               {"Suggestions reached", kNumber}},
              {}};
  for (const StudyMethod& m : record.statistics.methods) {
    std::vector<Cell> row{{m.method}};
    for (const int n : {m.sessions, m.calibrated, m.gave_up, m.good, m.caution, m.bad}) {
      row.push_back(number(std::to_string(n)));
    }
    row.push_back(orDash(m.median_capture_s, 1, "{:.1f}"));
    row.push_back(orDash(m.median_held_out_px, 1, "{:.4f}"));
    row.push_back(orDash(m.compliance, 100, "{:.0f} %"));
    table.rows.push_back(std::move(row));
  }
  return withTable({"methods", "Methods", "", {}, {}}, std::move(table));
}

Section failuresSection(const StudyRecord& record) {
  Table table{{{"Session"}, {"Participant"}, {"Method"}, {"Step"}, {"Message"}}, {}};
  for (const StudySession& s : record.sessions) {
    if (s.status != StudyStatus::kFailed) continue;
    table.rows.push_back({linkTo(s), {s.participant}, {s.method}, {s.failed_step}, {s.message}});
  }
  return withTable({"failures", "Failures", "Sessions without a calibration, and why.", {}, {}},
                   std::move(table));
}

Section sessionsSection(const StudyRecord& record) {
  Table table{{{"Session"},
               {"Participant"},
               {"Method"},
               {"Period", kNumber},
               {"Time [s]", kNumber},
               {"Camera RMSE [px]", kNumber},
               {"Held-out RMSE [px]", kNumber},
               {"Offset [ms]", kNumber},
               {"Verdict"}},
              {}};
  for (const StudySession& s : record.sessions) {
    Cell seconds = orDash(s.capture_s, 1, "{:.1f}");
    if (!s.finished) seconds.text += " (gave up)";
    table.rows.push_back({linkTo(s),
                          {s.participant},
                          {s.method},
                          number(std::to_string(s.period)),
                          std::move(seconds),
                          orDash(s.camera_rmse_px, 1, "{:.4f}"),
                          orDash(s.held_out_rmse_px, 1, "{:.4f}"),
                          offsetCell(s),
                          verdictCell(s)});
  }
  return withTable({"sessions", "All sessions", "A session's name leads to its page.", {}, {}},
                   std::move(table));
}

}  // namespace plumbline::html_internal
