// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/study/sections.h"
#include "report/plots/characters.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr double kBesides = 0.16;  // points stand about the middle of their box by this

/// A value of a session.
struct Sampled {
  const StudySession* session = nullptr;
  double value = 0;
  std::string what;  ///< beside the session's name; may be empty
};

/// Whether there is a value to draw.
bool isShown(const std::optional<double>& value) { return value && std::isfinite(*value); }

/// A point's place beside the middle, the same for the same position in its group: steps of 7
/// modulo 11 keep neighbours apart, and no page depends on chance.
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
  // Whiskers reach to the extremes: every value is drawn as a point as well.
  plot.boxes.push_back({name,
                        {quantile(values, 0), quantile(values, 0.25), quantile(values, 0.5),
                         quantile(values, 0.75), quantile(values, 1)},
                        series});
}

/// As wide as the page from five boxes on; `from_zero` where 0 means something, as for lengths.
Figure boxFigure(BoxPlot plot, const std::string& title, const std::string& label,
                 const std::string& id, const std::string& caption, bool from_zero) {
  if (plot.boxes.empty()) return {};
  std::size_t longest = 0;
  double top = 0;
  for (const BoxSummary& box : plot.boxes) {
    longest = std::max(longest, internal::characterCount(box.name));
    top = std::max(top, box.quantiles[4]);
  }
  const bool wide = plot.boxes.size() > 4;
  plot.frame.title = title;
  plot.frame.width = wide ? 960 : 480;
  // About as many letters fit side by side.
  plot.frame.x.upright_labels = longest * plot.boxes.size() > (wide ? 110U : 50U);
  plot.frame.height = plot.frame.x.upright_labels ? 400 : 320;
  plot.frame.y.label = label;
  if (from_zero) plot.frame.y.range = Range{0, top > 0 ? 1.08 * top : 1};
  return {toSvg(plot, id), caption, wide};
}

using Getter = std::function<std::optional<double>(const StudySession&)>;

/// Of the sessions of a method that have a finite value.
std::vector<Sampled> samplesOf(const StudyRecord& record, const std::string& method,
                               const Getter& get) {
  std::vector<Sampled> samples;
  for (const StudySession& s : record.sessions) {
    const auto value = s.method == method ? get(s) : std::nullopt;
    if (isShown(value)) samples.push_back({&s, *value, ""});
  }
  return samples;
}

/// A box a method, named by it: no legend repeats the names.
BoxPlot methodBoxes(const StudyRecord& record, const Getter& get, const char* format) {
  BoxPlot plot;
  for (std::size_t k = 0; k < record.methods.size(); ++k) {
    addBox(plot, record.methods[k], k, samplesOf(record, record.methods[k], get), format);
  }
  return plot;
}

/// Boxes of every (group, method) over rows of sessions; a row without a value has no point.
template <class Row, class Group, class Value>
BoxPlot groupedBoxes(const StudyRecord& record, const std::vector<Row>& rows, Group Row::*group,
                     Value Row::*value, const char* format) {
  BoxPlot plot;
  plot.series = record.methods;
  for (const std::string& name : distinct(rows, [&](const Row& r) { return r.*group; })) {
    for (std::size_t k = 0; k < record.methods.size(); ++k) {
      std::vector<Sampled> samples;
      for (const Row& row : rows) {
        const StudySession* s = sessionOf(record, row.session);
        // A row of a session that is not in the record has no method.
        const bool here = s && s->method == record.methods[k] && row.*group == name;
        if (here && isShown(row.*value)) samples.push_back({s, *(row.*value), name});
      }
      addBox(plot, name, k, samples, format);
    }
  }
  return plot;
}

}  // namespace

Section trajectorySection(const StudyRecord& record) {
  Section section{"trajectories", "Absolute trajectory errors",
                  "Odometry under every calibration: one value per calibration and run."};
  if (record.trajectories.empty()) return section;
  int incomplete = 0;
  for (const StudyTrajectory& t : record.trajectories) incomplete += isShown(t.ate_m) ? 0 : 1;
  const BoxPlot plot = groupedBoxes(record, record.trajectories, &StudyTrajectory::sequence,
                                    &StudyTrajectory::ate_m, "{:.4f} m");
  return withFigures(
      std::move(section),
      {boxFigure(plot, "ATE by sequence and method", "ATE RMSE [m]", "study-ate",
                 fmt::format("Whiskers at the best and the worst, box from 25 to 75 %, line at the "
                             "median; {} of {} runs are not complete and not included.",
                             incomplete, record.trajectories.size()),
                 true)});
}

Section heldOutSection(const StudyRecord& record) {
  Section section{
      "held-out", "Held-out errors",
      "Every calibration, fixed, on held-out recordings of the rig; only poses are estimated."};
  if (record.held_out.empty()) return section;
  const BoxPlot plot = groupedBoxes(record, record.held_out, &StudyHeldOut::recording,
                                    &StudyHeldOut::rmse_px, "{:.4f} px");
  const auto missing = std::ranges::count_if(
      record.held_out, [](const StudyHeldOut& h) { return !isShown(h.rmse_px); });
  std::string caption = "A point is a calibration and links to it.";
  if (missing > 0) {
    caption += fmt::format(" {} of {} have no RMSE and are not included.", missing,
                           record.held_out.size());
  }
  return withFigures(std::move(section),
                     {boxFigure(plot, "Held-out RMSE by recording and method", "RMSE [px]",
                                "study-held-out", caption, false)});
}

Section entropySection(const StudyRecord& record) {
  Section section{"entropies", "Entropies",
                  "Of the calibrations' parameters; lower: better determined. They compare only "
                  "under the same noise and parameters: sessions whose cameras have other lens "
                  "models than most have none of the camera stage here."};
  const BoxPlot cameras = methodBoxes(
      record, [](const StudySession& s) { return s.camera_entropy_nats; }, "{:.2f} nat");
  const BoxPlot imu = methodBoxes(
      record, [](const StudySession& s) { return s.camera_imu_entropy_nats; }, "{:.2f} nat");
  return withFigures(
      std::move(section),
      {boxFigure(cameras, "Camera stage", "entropy [nat]", "study-entropy-camera", "", false),
       boxFigure(imu, "Camera-IMU stage", "entropy [nat]", "study-entropy-imu", "", false)});
}

}  // namespace plumbline::html_internal
