// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/study/figures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "calibrator/base/statistics.h"
#include "report/html/study/tables.h"
#include "report/html/text.h"
#include "report/plots/svg.h"
#include "report/plots/ticks.h"

namespace plumbline::html_internal {
namespace {

constexpr double kBesides = 0.16;      // points stand about the middle of their box by this
constexpr std::size_t kNamed = 40;     // categories whose names fit below an axis
constexpr double kShownTerm_m = 2e-5;  // terms of a board that stay below are not drawn

/// A value of a session.
struct Sampled {
  const StudySession* session = nullptr;
  double value = 0;
  std::string what;  ///< beside the session's name; may be empty
};

std::size_t placeOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// A point's place beside the middle, the same for the same position in its group.
double beside(std::size_t i) { return kBesides * (static_cast<double>(i * 7 % 11) / 5 - 1); }

/// A box with its points, at the end of the plot.
void addBox(BoxPlot& plot, const std::string& name, std::size_t series,
            const std::vector<Sampled>& samples, const char* format) {
  if (samples.empty()) return;
  std::vector<double> values;
  const auto x = static_cast<double>(plot.boxes.size());
  for (const Sampled& s : samples) {
    plot.points.push_back({x + beside(values.size()), s.value,
                           s.session->name + (s.what.empty() ? "" : ", " + s.what) + ": " +
                               fmt::format(fmt::runtime(format), s.value),
                           s.session->page, seriesColour(series)});
    values.push_back(s.value);
  }
  plot.boxes.push_back({name,
                        {quantile(values, 0), quantile(values, 0.25), quantile(values, 0.5),
                         quantile(values, 0.75), quantile(values, 1)},
                        series});
}

Figure boxFigure(BoxPlot plot, const std::string& title, const std::string& label,
                 const std::string& id, const std::string& caption, bool from_zero) {
  std::size_t longest = 0;
  double top = 0;
  for (const BoxSummary& box : plot.boxes) {
    longest = std::max(longest, box.name.size());
    top = std::max(top, box.quantiles[4]);
  }
  const bool wide = plot.boxes.size() > 4;
  plot.frame.title = title;
  plot.frame.width = wide ? 960 : 480;
  plot.frame.x.upright_labels = longest * plot.boxes.size() > (wide ? 110U : 50U);
  plot.frame.height = plot.frame.x.upright_labels ? 400 : 320;
  plot.frame.y.label = label;
  if (from_zero) plot.frame.y.range = Range{0, top > 0 ? 1.08 * top : 1};
  return {toSvg(plot, id), caption, wide};
}

using Getter = std::function<std::optional<double>(const StudySession&)>;

std::vector<Sampled> samplesOf(const StudyRecord& record, const std::string& method,
                               const Getter& get) {
  std::vector<Sampled> samples;
  for (const StudySession& s : record.sessions) {
    const auto value = s.method == method ? get(s) : std::nullopt;
    if (value && std::isfinite(*value)) samples.push_back({&s, *value, ""});
  }
  return samples;
}

BoxPlot methodBoxes(const StudyRecord& record, const Getter& get, const char* format) {
  BoxPlot plot;
  for (std::size_t k = 0; k < record.methods.size(); ++k) {
    addBox(plot, record.methods[k], k, samplesOf(record, record.methods[k], get), format);
  }
  return plot;
}

/// Boxes of every (group, method); `values` of a pair.
template <class Values>
BoxPlot groupedBoxes(const StudyRecord& record, const std::vector<std::string>& groups,
                     const Values& values, const char* format) {
  BoxPlot plot;
  plot.series = record.methods;
  for (const std::string& group : groups) {
    for (std::size_t k = 0; k < record.methods.size(); ++k) {
      addBox(plot, group, k, values(group, record.methods[k]), format);
    }
  }
  return plot;
}

template <class Rows, class Name>
std::vector<std::string> distinct(const Rows& rows, const Name& name) {
  std::vector<std::string> names;
  for (const auto& row : rows) {
    if (placeOf(names, name(row)) == names.size()) names.push_back(name(row));
  }
  return names;
}

std::vector<std::string> stagesOf(const StudyRecord& record) {
  std::vector<std::string> names;
  for (const StudySession& s : record.sessions) {
    for (const CaptureStage& stage : s.stages) {
      if (placeOf(names, stage.name) == names.size()) names.push_back(stage.name);
    }
  }
  return names;
}

double secondsOf(const StudySession& s, const std::string& stage) {
  double seconds = 0;
  for (const CaptureStage& c : s.stages) seconds += c.name == stage ? c.seconds : 0;
  return seconds;
}

/// The medians of the methods, then every session.
Figure stagesFigure(const StudyRecord& record) {
  BarPlot plot;
  plot.stacked = true;
  plot.names = stagesOf(record);
  if (plot.names.empty()) return {};
  for (const std::string& method : record.methods) {
    plot.categories.push_back("median " + method);
    plot.links.emplace_back();
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
        if (s.method == method && !s.stages.empty()) seconds.push_back(secondsOf(s, stage));
      }
      values.push_back(seconds.empty() ? 0 : median(seconds));
    }
    for (const StudySession& s : record.sessions) {
      if (!s.stages.empty()) values.push_back(secondsOf(s, stage));
    }
  }
  const std::size_t step = plot.categories.size() / kNamed + 1;  // names that do not touch
  for (std::size_t i = 0; i < plot.categories.size(); ++i) {
    if (i >= record.methods.size() && i % step != 0) continue;
    plot.frame.x.ticks.push_back({static_cast<double>(i), plot.categories[i]});
  }
  plot.frame.title = "Time of the participants by stage";
  plot.frame.width = 960;
  plot.frame.height = 420;
  plot.frame.x.upright_labels = true;
  plot.frame.y.label = "time [s]";
  return {toSvg(plot, "study-stages"),
          "The medians of the methods first, then every session; a bar leads to its session's "
          "page.",
          true};
}

Figure survivalFigure(const StudyRecord& record) {
  LinePlot plot;
  for (std::size_t k = 0; k < record.statistics.survival.size(); ++k) {
    const StudySurvival& s = record.statistics.survival[k];
    if (s.participants == 0) continue;
    Series steps{s.method, {0}, {1}, seriesColour(k), 2, false, false};
    double height = 1;
    for (const SurvivalStep& step : s.curve) {
      steps.x.insert(steps.x.end(), {step.t_s, step.t_s});
      steps.y.insert(steps.y.end(), {height, step.unfinished});
      height = step.unfinished;
    }
    steps.x.push_back(record.limit_s);
    steps.y.push_back(height);
    plot.series.push_back(std::move(steps));
  }
  if (plot.series.empty()) return {};
  plot.frame.title = "Share of participants who are not done";
  plot.frame.width = 960;
  plot.frame.height = 300;
  plot.frame.x = {"time [s]", Range{0, record.limit_s}, {}, false, false};
  plot.frame.y = {"share", Range{0, 1.03}, {}, false, false};
  return {toSvg(plot, "study-survival"),
          "Kaplan-Meier's estimate; who gives up counts as not done until the limit.", true};
}

Section withFigure(Section section, Figure figure) {
  if (!figure.svg.empty()) section.blocks.push_back({"", "", {}, {}, {std::move(figure)}});
  return section;
}

Table offsetTable(const StudyRecord& record) {
  Table table{{{"Method"},
               {"Sessions", kNumber},
               {"Mean [ms]", kNumber},
               {"Std over sessions [ms]", kNumber},
               {"Median stated std [ms]", kNumber}},
              {}};
  for (const StudyMethod& m : record.statistics.methods) {
    std::vector<double> stated;
    std::size_t count = 0;
    for (const StudySession& s : record.sessions) {
      if (s.method != m.method || !s.time_offset_s) continue;
      ++count;
      if (s.time_offset_std_s) stated.push_back(*s.time_offset_std_s);
    }
    if (count == 0) continue;
    table.rows.push_back({{m.method},
                          number(std::to_string(count)),
                          orDash(m.time_offset_mean_s, 1e3, "{:.4f}"),
                          orDash(m.time_offset_std_s, 1e3, "{:.2g}"),
                          number(stated.empty() ? kDash : twoDigits(1e3 * median(stated)))});
  }
  return table;
}

/// Every session's offset with one deviation both ways.
Figure offsetFigure(const StudyRecord& record) {
  LinePlot plot;
  for (std::size_t k = 0; k < record.methods.size(); ++k) {
    plot.series.push_back({record.methods[k], {}, {}, seriesColour(k), 1.2, false, false});
  }
  std::vector<double> ends;
  for (const StudySession& s : record.sessions) {
    if (!s.time_offset_s || !std::isfinite(*s.time_offset_s)) continue;
    const auto x = static_cast<double>(plot.points.size());
    const double ms = 1e3 * *s.time_offset_s, std_ms = 1e3 * s.time_offset_std_s.value_or(0);
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
  plot.frame.title = "Time offset of every session";
  plot.frame.width = 960;
  plot.frame.height = 320;
  plot.frame.x = {"session, in the study's order",
                  Range{-0.7, static_cast<double>(plot.points.size()) - 0.3},
                  {},
                  false,
                  false};
  plot.frame.y = {"t_d [ms]", rangeOf({&ends}, 0.06), {}, false, false};
  return {toSvg(plot, "study-offsets"),
          "Lines reach one stated standard deviation both ways; t_imu = t_cam + t_d.", true};
}

Table spreadTable(const StudyRecord& record) {
  Table table{{{"Parameter", Cell::Kind::kCode},
               {"Method"},
               {"Sessions", kNumber},
               {"Mean", kNumber},
               {"Spread", kNumber},
               {"Stated", kNumber},
               {"Unit"},
               {"Ratio", kNumber},
               {"95 % if true", kNumber}},
              {}};
  for (const StudySpread& s : record.statistics.spread) {
    const auto [unit, factor] = readable(s.unit);
    Cell ratio = number(fmt::format("{:.2f}", s.ratio));
    if (s.ratio > s.high || s.ratio < s.low) ratio.level = VerdictLevel::kCaution;
    table.rows.push_back({code(s.parameter),
                          {s.method},
                          number(std::to_string(s.sessions)),
                          number(withPrecisionOf(factor * s.mean, factor * s.std)),
                          number(twoDigits(factor * s.std)),
                          number(twoDigits(factor * s.stated_std)),
                          {unit},
                          ratio,
                          number(fmt::format("{:.2f} to {:.2f}", s.low, s.high))});
  }
  return table;
}

Figure spreadFigure(const StudyRecord& record) {
  const auto& all = record.statistics.spread;
  const auto names = distinct(all, [](const StudySpread& s) { return s.parameter; });
  if (names.empty()) return {};
  LinePlot plot;
  double top = 2;
  double low = 0, high = std::numeric_limits<double>::infinity();
  for (const StudySpread& s : all) {
    const std::size_t k = placeOf(record.methods, s.method);
    const double x =
        static_cast<double>(placeOf(names, s.parameter)) +
        0.25 * (static_cast<double>(k) - 0.5 * static_cast<double>(record.methods.size() - 1));
    plot.points.push_back({x, s.ratio,
                           fmt::format("{}, {}: {:.2f}", s.parameter, s.method, s.ratio), "",
                           seriesColour(k)});
    top = std::max(top, s.ratio);
    low = std::max(low, s.low);
    high = std::min(high, s.high);
  }
  const double right = static_cast<double>(names.size()) - 0.5;
  for (const double level : {low, 1.0, high}) {
    plot.series.push_back({level == 1 ? "stated deviation" : "",
                           {-0.5, right},
                           {level, level},
                           {90, 98, 110, 255},
                           1.2,
                           level != 1,
                           false});
  }
  for (std::size_t k = 0; k < record.methods.size(); ++k) {
    plot.series.push_back({record.methods[k], {}, {}, seriesColour(k), 2, false, false});
  }
  plot.frame.title = "Spread over sessions over the stated deviation";
  plot.frame.width = 960;
  plot.frame.height = 380;
  plot.frame.x = {"", Range{-0.5, right}, {}, false, true};
  for (std::size_t i = 0; i < names.size(); ++i) {
    plot.frame.x.ticks.push_back({static_cast<double>(i), names[i]});
  }
  plot.frame.y = {"ratio", Range{0, 1.08 * std::min(top, 10.0)}, {}, false, false};
  return {toSvg(plot, "study-spread"),
          "1: the sessions of one rig spread as each of them states. Dashed: 95 % of ratios would "
          "lie between, were the deviations true (of the method with most sessions).",
          true};
}

}  // namespace

Section timeSection(const StudyRecord& record) {
  Section section{"time", "Time", "", {}, {}};
  section = withFigure(std::move(section), stagesFigure(record));
  return withFigure(std::move(section), survivalFigure(record));
}

Section trajectorySection(const StudyRecord& record) {
  Section section{"trajectories",
                  "Absolute trajectory errors",
                  "Odometry under every calibration: one value a calibration and run.",
                  {},
                  {}};
  if (record.trajectories.empty()) return section;
  const auto sequences =
      distinct(record.trajectories, [](const StudyTrajectory& t) { return t.sequence; });
  int failed = 0;
  for (const StudyTrajectory& t : record.trajectories) failed += t.ate_m ? 0 : 1;
  const BoxPlot plot = groupedBoxes(
      record, sequences,
      [&](const std::string& sequence, const std::string& method) {
        std::vector<Sampled> samples;
        for (const StudyTrajectory& t : record.trajectories) {
          const StudySession* s = sessionOf(record, t.session);
          if (!s || s->method != method || t.sequence != sequence || !t.ate_m) continue;
          samples.push_back({s, *t.ate_m, t.sequence});
        }
        return samples;
      },
      "{:.4f} m");
  if (plot.boxes.empty()) return section;
  return withFigure(
      std::move(section),
      boxFigure(plot, "ATE by sequence and method", "ATE RMSE [m]", "study-ate",
                fmt::format("Whiskers at the best and the worst, box from 25 to 75 %, "
                            "line at the median; {} of {} runs failed and are not in "
                            "it.",
                            failed, record.trajectories.size()),
                true));
}

Section heldOutSection(const StudyRecord& record) {
  Section section{
      "held-out",
      "Held-out errors",
      "Every calibration, held fixed, on recordings of the rig that no method saw; only "
      "poses move.",
      {},
      {}};
  if (record.held_out.empty()) return section;
  const auto recordings =
      distinct(record.held_out, [](const StudyHeldOut& h) { return h.recording; });
  const BoxPlot plot = groupedBoxes(
      record, recordings,
      [&](const std::string& recording, const std::string& method) {
        std::vector<Sampled> samples;
        for (const StudyHeldOut& h : record.held_out) {
          const StudySession* s = sessionOf(record, h.session);
          if (!s || s->method != method || h.recording != recording || !h.rmse_px) continue;
          samples.push_back({s, *h.rmse_px, h.recording});
        }
        return samples;
      },
      "{:.4f} px");
  if (plot.boxes.empty()) return section;
  return withFigure(
      std::move(section),
      boxFigure(plot, "Held-out RMSE by recording and method", "RMSE [px]", "study-held-out",
                "A point is a calibration and leads to it.", false));
}

Section entropySection(const StudyRecord& record) {
  Section section{"entropies",
                  "Entropies",
                  "Of the calibrations' parameters; lower is better known. They compare only under "
                  "the same noise and parameters.",
                  {},
                  {}};
  const BoxPlot cameras = methodBoxes(
      record, [](const StudySession& s) { return s.camera_entropy_nats; }, "{:.2f} nat");
  const BoxPlot imu = methodBoxes(
      record, [](const StudySession& s) { return s.camera_imu_entropy_nats; }, "{:.2f} nat");
  Block block;
  if (!cameras.boxes.empty()) {
    block.figures.push_back(
        boxFigure(cameras, "Camera stage", "entropy [nat]", "study-entropy-camera", "", false));
  }
  if (!imu.boxes.empty()) {
    block.figures.push_back(
        boxFigure(imu, "Camera-IMU stage", "entropy [nat]", "study-entropy-imu", "", false));
  }
  if (!block.figures.empty()) section.blocks.push_back(std::move(block));
  return section;
}

Section offsetSection(const StudyRecord& record) {
  Section section{"offsets", "Time offset", "", {}, {}};
  Table table = offsetTable(record);
  if (table.rows.empty()) return section;
  section.blocks.push_back({"", "", std::move(table), {}, {offsetFigure(record)}});
  return section;
}

Section spreadSection(const StudyRecord& record) {
  Section section{"spread",
                  "Are the stated deviations true?",
                  "Sessions of one rig should spread as far as each of them states. Ratio: "
                  "sqrt(chi\u00b2 / (n \u2212 1)) about the weighted mean; above its interval the "
                  "deviations are too small, below too large.",
                  {},
                  {}};
  Table table = spreadTable(record);
  if (table.rows.empty()) return section;
  section.blocks.push_back({"", "", {}, {}, {spreadFigure(record)}});
  section.blocks.push_back({"Every parameter", "", std::move(table), {}, {}});
  return section;
}

Section boardSection(const StudyRecord& record) {
  Section section{
      "board",
      "The board over the sessions",
      "Terms of the target's shape as each calibration estimated it: a drift is a board "
      "that changes.",
      {},
      {}};
  LinePlot plot;
  std::vector<double> ends{0};
  double last = 0;
  for (int j = 0; j < kTargetTerms; ++j) {
    Series line{kTargetTermNames[static_cast<std::size_t>(j)],
                {},
                {},
                seriesColour(plot.series.size()),
                1.4,
                false,
                false};
    std::vector<NamedPoint> points;
    double largest_m = 0;
    for (std::size_t i = 0; i < record.sessions.size(); ++i) {
      const StudySession& s = record.sessions[i];
      if (!s.board) continue;
      const double mm = 1e3 * s.board->terms[j];
      largest_m = std::max(largest_m, std::abs(s.board->terms[j]));
      last = std::max(last, static_cast<double>(i));
      line.x.push_back(static_cast<double>(i));
      line.y.push_back(mm);
      points.push_back({static_cast<double>(i), mm,
                        fmt::format("{}, {}: {:+.3f} mm", s.name, line.name, mm), s.page,
                        line.colour});
    }
    if (line.x.size() < 2 || largest_m < kShownTerm_m) continue;
    ends.insert(ends.end(), line.y.begin(), line.y.end());
    plot.points.insert(plot.points.end(), points.begin(), points.end());
    plot.series.push_back(std::move(line));
  }
  if (plot.series.empty()) return section;
  plot.frame.title = "Shape of the board";
  plot.frame.width = 960;
  plot.frame.height = 380;
  plot.frame.x = {"session, in the study's order", Range{-0.5, last + 0.5}, {}, false, false};
  plot.frame.y = {"RMS displacement [mm]", rangeOf({&ends}, 0.08), {}, false, false};
  return withFigure(std::move(section), {toSvg(plot, "study-board"),
                                         "Terms that stay below 0.02 mm are left out.", true});
}

}  // namespace plumbline::html_internal
