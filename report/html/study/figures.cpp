// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/study/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr std::size_t kNamed = 40;  // categories whose names fit below an axis

std::vector<std::string> stagesOf(const StudyRecord& record) {
  std::vector<CaptureStage> all;
  for (const StudySession& s : record.sessions) {
    all.insert(all.end(), s.stages.begin(), s.stages.end());
  }
  return distinct(all, [](const CaptureStage& stage) { return stage.name; });
}

double secondsOf(const StudySession& s, const std::string& stage) {
  double seconds = 0;
  for (const CaptureStage& c : s.stages) seconds += c.name == stage ? c.seconds : 0;
  return seconds;
}

/// Page of the session that took nearest to the median time of those who finished with the method.
std::string typicalPage(const StudyRecord& record, const std::string& method) {
  const auto timeOf = [&](const StudySession& s) -> std::optional<double> {
    if (s.method != method || !s.finished || s.stages.empty()) return std::nullopt;
    double seconds = 0;
    for (const CaptureStage& stage : s.stages) seconds += stage.seconds;
    return seconds;
  };
  std::vector<double> times;
  for (const StudySession& s : record.sessions) {
    if (const auto seconds = timeOf(s)) times.push_back(*seconds);
  }
  return times.empty() ? "" : pageNearest(record.sessions, median(times), timeOf);
}

/// The medians of the methods, then every session.
Figure stagesFigure(const StudyRecord& record) {
  BarPlot plot;
  plot.frame = {"Time of the participants by stage", {}, {"time [s]"}, 960, 420};
  plot.frame.x.upright_labels = true;
  plot.stacked = true;
  plot.names = stagesOf(record);
  if (plot.names.empty()) return {};
  for (const std::string& method : record.methods) {
    plot.categories.push_back("median " + method);
    plot.links.push_back(typicalPage(record, method));
  }
  for (const StudySession& s : record.sessions) {
    if (s.stages.empty()) continue;
    plot.categories.push_back(s.name + (s.finished ? "" : " (gave up)"));
    plot.links.push_back(s.page);
  }
  for (const std::string& stage : plot.names) {
    auto& values = plot.values.emplace_back();
    for (const std::string& method : record.methods) {
      std::vector<double> seconds;
      for (const StudySession& s : record.sessions) {
        const bool counts = s.method == method && s.finished && !s.stages.empty();
        if (counts) seconds.push_back(secondsOf(s, stage));
      }
      // Stage by stage: the bar's whole is no median of whole times.
      values.push_back(seconds.empty() ? 0 : median(seconds));
    }
    for (const StudySession& s : record.sessions) {
      if (!s.stages.empty()) values.push_back(secondsOf(s, stage));
    }
  }
  // The recording's own word is an identifier.
  std::ranges::replace(plot.names, std::string("camera_imu"), std::string("camera-IMU"));
  const std::size_t step = plot.categories.size() / kNamed + 1;  // names that do not touch
  for (std::size_t i = 0; i < plot.categories.size(); ++i) {
    // The medians come first, and keep their names in any case.
    if (i >= record.methods.size() && i % step != 0) continue;
    plot.frame.x.ticks.push_back({static_cast<double>(i), plot.categories[i]});
  }
  return {toSvg(plot, "study-stages"),
          "First the medians of the methods, over those who finished, then every session; a bar "
          "links to its session's page, the bar of a median to the closest session's.",
          true};
}

/// The height of a curve of Kaplan and Meier after a time.
double heightAt(const StudySurvival& s, double t_s) {
  double height = 1;
  for (const SurvivalStep& step : s.curve) {
    // Steps ascend in time; at a step the curve has its lower height, as its points do.
    if (step.t_s <= t_s) height = step.unfinished;
  }
  return height;
}

/// Every session where it ended, at the curve's height: on its step where a participant has no
/// other session of the method, at the limit where it was given up.
void addEnds(const StudyRecord& record, const StudySurvival& s, const Colour& colour,
             LinePlot& plot) {
  for (const StudySession& session : record.sessions) {
    if (session.method != s.method || (session.finished && !session.capture_s)) continue;
    // Whoever gave up is not done until the limit, as the curve has it.
    const bool done = session.finished && *session.capture_s <= record.limit_s;
    const double t = done ? *session.capture_s : record.limit_s;
    plot.points.push_back({t, heightAt(s, t),
                           fmt::format("{}: {}", session.name,
                                       done               ? fmt::format("done after {:.1f} s", t)
                                       : session.finished ? "not done at the limit"
                                                          : "gave up"),
                           session.page, colour});
  }
}

Figure survivalFigure(const StudyRecord& record) {
  LinePlot plot;
  for (std::size_t k = 0; k < record.statistics.survival.size(); ++k) {
    const StudySurvival& s = record.statistics.survival[k];
    if (s.participants == 0) continue;
    Series steps{s.method, {0}, {1}, seriesColour(k), 2};
    double height = 1;
    for (const SurvivalStep& step : s.curve) {
      // Level up to the step, then down: two points at its time.
      steps.x.insert(steps.x.end(), {step.t_s, step.t_s});
      steps.y.insert(steps.y.end(), {height, step.unfinished});
      height = step.unfinished;
    }
    // Nobody is followed beyond the limit.
    steps.x.push_back(record.limit_s);
    steps.y.push_back(height);
    plot.series.push_back(std::move(steps));
    addEnds(record, s, seriesColour(k), plot);
  }
  if (plot.series.empty()) return {};
  // A little above 1, where every curve begins.
  plot.frame = {"Share of participants who are not done",
                {"time [s]", Range{0, record.limit_s}},
                {"share", Range{0, 1.03}},
                960,
                300};
  return {toSvg(plot, "study-survival"),
          "Kaplan-Meier estimate over participants, of several sessions of one the mean time; "
          "participants who gave up count as not done until the limit. A point is a session and "
          "links to it.",
          true};
}

/// The scatter over sessions beside the deviations that the calibrations state, which are formal
/// ones.
Table offsetTable(const StudyRecord& record) {
  Table table{{words("Method"), number("Sessions"), number("Mean [ms]"),
               number("Std over sessions [ms]"), number("Median formal std [ms]")}};
  for (const StudyMethod& m : record.statistics.methods) {
    std::vector<double> stated;
    std::size_t count = 0;
    for (const StudySession& s : record.sessions) {
      if (s.method != m.method || !s.time_offset_s) continue;
      ++count;
      if (s.time_offset_std_s) stated.push_back(*s.time_offset_std_s);
    }
    if (count == 0) continue;
    const double formal_s = stated.empty() ? 0 : median(stated);
    // To the digits of the spread; one session has none.
    const double known_s = m.time_offset_std_s.value_or(formal_s);
    table.rows.push_back(
        {words(m.method), number(count),
         number(m.time_offset_mean_s ? withPrecisionOf(1e3 * *m.time_offset_mean_s, 1e3 * known_s)
                                     : kDash),
         orDash(m.time_offset_std_s, 1e3, "{:.2g}"),
         number(stated.empty() ? kDash : twoDigits(1e3 * formal_s))});
  }
  return table;
}

/// Every session's offset with one deviation both ways.
Figure offsetFigure(const StudyRecord& record) {
  LinePlot plot;
  for (std::size_t k = 0; k < record.methods.size(); ++k) {
    plot.series.push_back({record.methods[k], {}, {}, seriesColour(k), 1.2});
  }
  std::vector<double> ends;
  for (std::size_t i = 0; i < record.sessions.size(); ++i) {
    const StudySession& s = record.sessions[i];
    if (!s.time_offset_s || !std::isfinite(*s.time_offset_s)) continue;
    const auto x = static_cast<double>(i + 1);
    const double ms = 1e3 * *s.time_offset_s, std_ms = 1e3 * s.time_offset_std_s.value_or(0);
    // One past the last for a method that the study does not list: a point without a line.
    const std::size_t k = placeOf(record.methods, s.method);
    plot.points.push_back({x, ms, fmt::format("{}: {:.4f} \u00b1 {:.2g} ms", s.name, ms, std_ms),
                           s.page, seriesColour(k)});
    if (k < record.methods.size()) {  // NaN breaks the line
      plot.series[k].x.insert(plot.series[k].x.end(), {x, x, std::nan("")});
      plot.series[k].y.insert(plot.series[k].y.end(), {ms - std_ms, ms + std_ms, std::nan("")});
    }
    ends.insert(ends.end(), {ms - std_ms, ms + std_ms});
  }
  if (plot.points.empty()) return {};
  plot.frame = {"Time offset of every session",
                sessionAxis(record.sessions.size()),
                {"t_d [ms]", rangeOf({&ends}, 0.06)},
                960,
                320};
  return {toSvg(plot, "study-offsets"),
          "Lines are plus and minus one formal standard deviation; t_imu = t_cam + t_d.", true};
}

}  // namespace

PlotAxis sessionAxis(std::size_t sessions) {
  constexpr std::size_t kMostTicks = 20;
  PlotAxis axis{"session, in the study's order", Range{0.3, static_cast<double>(sessions) + 0.7}};
  // Whole numbers, as there is no session between two.
  const std::size_t step = std::max<std::size_t>(1, (sessions + kMostTicks - 1) / kMostTicks);
  for (std::size_t i = 1; i <= sessions; i += step) {
    axis.ticks.push_back({static_cast<double>(i), std::to_string(i)});
  }
  return axis;
}

Section timeSection(const StudyRecord& record) {
  Section section{"time", "Time", ""};
  section = withFigures(std::move(section), {stagesFigure(record)});
  return withFigures(std::move(section), {survivalFigure(record)});
}

Section offsetSection(const StudyRecord& record) {
  Section section{"offsets", "Time offset", ""};
  Table table = offsetTable(record);
  if (table.rows.empty()) return section;
  section.blocks.push_back({"", "", std::move(table), {}, {offsetFigure(record)}});
  return section;
}

}  // namespace plumbline::html_internal
