// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "report/html/study/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

Cell offsetCell(const StudySession& s) {
  if (!s.time_offset_s) return number(kDash);
  return number(withPrecisionOf(1e3 * *s.time_offset_s, 1e3 * s.time_offset_std_s.value_or(0)));
}

Cell verdictCell(const StudySession& s) {
  if (s.status == StudyStatus::kFailed) {
    return {"failed at " + s.failed_step, Cell::Kind::kText, VerdictLevel::kBad};
  }
  const std::string level = s.verdict ? toString(*s.verdict) : kDash;
  return {s.verdict_rule.empty() ? level : level + ": " + s.verdict_rule, Cell::Kind::kText,
          s.verdict};
}

/// A link, or the name alone of a session that the record does not have (any more, or of the study
/// as a whole).
Cell named(const StudyRecord& record, const std::string& session) {
  const StudySession* s = sessionOf(record, session);
  return s ? linkTo(*s) : tight(session);
}

/// What went wrong with a session, and why: of a calibration that is not there, or whose verdict is
/// bad. Nobody states why a participant gave up. Empty if nothing did.
struct Problem {
  std::string what, why;
};

Problem problemOf(const StudySession& s) {
  Problem problem;
  if (!s.finished) problem = {"gave up", kDash};
  const auto add = [&](const std::string& what, const std::string& why) {
    problem = {problem.what.empty() ? what : problem.what + ", " + what, why};
  };
  // Without a calibration there is no verdict to name.
  if (s.status == StudyStatus::kFailed) {
    add("failed at " + s.failed_step, s.message);
  } else if (s.verdict == VerdictLevel::kBad) {
    add("bad verdict", s.verdict_sentence);
  }
  return problem;
}

/// The differences that are largest in deviations.
std::string largestDifferences(const StudyOther& other) {
  std::vector<StudyDifference> all = other.differences;
  // Without a deviation of Plumbline's there is no order among units.
  std::erase_if(all, [](const StudyDifference& d) { return !d.sigmas; });
  std::ranges::stable_sort(all, std::greater(),
                           [](const StudyDifference& d) { return std::abs(*d.sigmas); });
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, all.size()); ++i) {
    text += fmt::format("{}{} {:+.2g} \u03c3", i > 0 ? ", " : "", all[i].parameter, *all[i].sigmas);
  }
  return text.empty() ? kDash : text;
}

/// From the second night on that has a held-out error.
Figure nightsFigure(const StudyRecord& record) {
  LinePlot plot;
  Series line{"median held-out RMSE", {}, {}, seriesColour(0), 1.6};
  double top = 0;
  for (const StudyNight& n : record.nights) {
    if (!n.held_out_rmse_px) continue;
    line.x.push_back(n.night);
    line.y.push_back(*n.held_out_rmse_px);
    top = std::max(top, *n.held_out_rmse_px);
  }
  if (line.x.size() < 2) return {};
  // Pages are this night's, the last one's: its point, where it has one, leads to the session
  // nearest to the median, an earlier one to the sessions as they are now.
  std::string tonight;
  if (record.nights.back().held_out_rmse_px) {
    tonight = pageNearest(record.sessions, line.y.back(),
                          [](const StudySession& s) { return s.held_out_rmse_px; });
  }
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    const bool last = i + 1 == line.x.size() && !tonight.empty();
    plot.points.push_back({line.x[i], line.y[i],
                           fmt::format("night {:g}: {:.4f} px", line.x[i], line.y[i]),
                           last ? tonight : "#sessions", seriesColour(0)});
  }
  plot.frame = {"Held-out RMSE over the nights",
                {"night", Range{line.x.front() - 0.5, line.x.back() + 0.5}},
                {"median over sessions [px]", Range{0, top > 0 ? 1.1 * top : 1}},
                960,
                260};
  plot.series.push_back(std::move(line));
  return {toSvg(plot, "study-nights"), "", true};
}

Table nightsTable(const StudyRecord& record) {
  Table table{{number("Night"), words("Date"), words("Version"), number("Sessions"),
               number("Failed"), number("Alarms"), number("Time [s]")}};
  for (const StudyNight& n : record.nights) {
    table.rows.push_back({number(n.night), tight(n.date), tight(n.version), number(n.sessions),
                          number(n.failed), number(n.alarms), orDash(n.seconds, 1, "{:.0f}")});
  }
  return table;
}

/// With the command that makes the figure again by hand.
Table alarmsTable(const StudyRecord& record) {
  Table table{{words("Figure"), words("Session"), number("First bad night"), words("By"),
               number("Was"), number("Is"), code("To run again")}};
  for (const StudyAlarm& a : record.alarms) {
    Cell figure = code(a.metric);
    figure.level = VerdictLevel::kBad;
    // Of a drift `is` is a share where there is one, and no value was before it.
    const std::string drift = hasShare(a) ? fmt::format("{:+.3g} %", 100 * a.is) : kDash;
    table.rows.push_back({figure, named(record, a.session), number(a.night), words(a.kind),
                          number(isDrift(a) ? kDash : fmt::format("{:.6g}", a.was)),
                          number(isDrift(a) ? drift : fmt::format("{:.6g}", a.is)),
                          code(a.command)});
  }
  return table;
}

}  // namespace

Cell linkTo(const StudySession& s) { return {s.name, Cell::Kind::kTight, {}, s.page}; }

const StudySession* sessionOf(const StudyRecord& record, const std::string& name) {
  const auto found = std::ranges::find(record.sessions, name, &StudySession::name);
  return found == record.sessions.end() ? nullptr : &*found;
}

Section othersSection(const StudyRecord& record) {
  Table table{{words("Session"), words("Tool"), number("Held-out RMSE [px]"),
               number("Plumbline [px]"), words("Largest differences from Plumbline")}};
  for (const StudyOther& o : record.others) {
    const StudySession* s = sessionOf(record, o.session);
    Cell differences{o.failure.empty() ? largestDifferences(o) : "failed: " + o.failure};
    if (!o.failure.empty()) differences.level = VerdictLevel::kBad;
    table.rows.push_back(
        {named(record, o.session), words(o.tool), orDash(o.held_out_rmse_px, 1, "{:.4f}"),
         orDash(s ? s->held_out_rmse_px : std::nullopt, 1, "{:.4f}"), differences});
  }
  return withTable({"tools", "Other tools",
                    "Their calibrations of the same recordings, scored on the same held-out ones; "
                    "differences in Plumbline's formal standard deviations."},
                   std::move(table));
}

Section nightsSection(const StudyRecord& record) {
  Section section{"nights", "Nights and alarms",
                  "Figures of the same inputs and version must repeat; others are compared with "
                  "the nights before."};
  section = withTable(std::move(section), alarmsTable(record), "Alarms");
  if (record.nights.empty()) return section;
  section = withTable(std::move(section), nightsTable(record), "Nights");
  return withFigures(std::move(section), {nightsFigure(record)});
}

Section failuresSection(const StudyRecord& record) {
  Table table{
      {words("Session"), words("Participant"), words("Method"), words("What"), words("Why")}};
  for (const StudySession& s : record.sessions) {
    const Problem problem = problemOf(s);
    if (problem.what.empty()) continue;
    Cell why{problem.why};
    if (problem.why != kDash) why.level = VerdictLevel::kBad;
    table.rows.push_back({linkTo(s), {s.participant}, {s.method}, {problem.what}, why});
  }
  return withTable({"failures", "Failures and bad verdicts",
                    "Sessions without a calibration, with a bad verdict, or whose participant gave "
                    "up."},
                   std::move(table));
}

Section sessionsSection(const StudyRecord& record) {
  Table table{{words("Session"), words("Participant"), words("Method"), number("Period"),
               number("Time [s]"), number("Camera [px]"), number("Held out [px]"),
               number("Offset [ms]"), number("Suggestions reached"), words("Verdict")}};
  for (const StudySession& s : record.sessions) {
    Cell seconds = orDash(s.capture_s, 1, "{:.1f}");
    if (!s.finished) seconds.text += " (gave up)";
    table.rows.push_back({linkTo(s), words(s.participant), words(s.method), number(s.period),
                          std::move(seconds), orDash(s.camera_rmse_px, 1, "{:.4f}"),
                          orDash(s.held_out_rmse_px, 1, "{:.4f}"), offsetCell(s),
                          orDash(s.compliance, 100, "{:.0f} %"), verdictCell(s)});
  }
  const bool guided =
      std::ranges::any_of(record.sessions, [](const auto& s) { return s.compliance.has_value(); });
  if (!guided) eraseColumns(table, 8);
  return withTable({"sessions", "All sessions",
                    "A name links to the session's page; a click on a heading sorts."},
                   std::move(table));
}

}  // namespace plumbline::html_internal
