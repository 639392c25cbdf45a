// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "report/html/calibration/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr std::size_t kMostRows = 12;  // of the table of gaps

std::string milliseconds(double s) { return fmt::format("{:.3f}", 1e3 * s); }

Table sensorTable(const std::vector<SampleIntervals>& sensors) {
  Table table{{tight("Sensor"), number("Samples"), number("Rate [Hz]"), number("Median [ms]"),
               number("Shortest [ms]"), number("Longest [ms]"), number("1 to 99 % [ms]"),
               number("Gaps"), number("Missing")}};
  for (const SampleIntervals& s : sensors) {
    table.rows.push_back({tight(s.sensor), number(grouped(s.samples)),
                          // By the median, which gaps leave as it is.
                          number(s.median_s > 0 ? fmt::format("{:.2f}", 1 / s.median_s) : kDash),
                          number(milliseconds(s.median_s)), number(milliseconds(s.min_s)),
                          number(milliseconds(s.max_s)), number("{:.3g}", 1e3 * s.spread_s),
                          number(s.gap_count), number(s.missing)});
  }
  return table;
}

struct NamedGap {
  std::string sensor;
  SampleGap gap;
};

/// The gaps of all sensors, the longest of them, in the order of time.
std::vector<NamedGap> longestGaps(const std::vector<SampleIntervals>& sensors) {
  std::vector<NamedGap> gaps;
  for (const SampleIntervals& s : sensors) {
    for (const SampleGap& gap : s.gaps) gaps.push_back({s.sensor, gap});
  }
  std::ranges::stable_sort(gaps, std::greater(),
                           [](const NamedGap& g) { return g.gap.duration_s; });
  gaps.resize(std::min(gaps.size(), kMostRows));
  std::ranges::stable_sort(gaps, {}, [](const NamedGap& g) { return g.gap.t; });
  return gaps;
}

Table gapTable(const std::vector<NamedGap>& gaps, TimeNs origin) {
  Table table{{tight("Sensor"), number("After [s]"), number("Stamp [ns]"), number("Interval [ms]"),
               number("Missing")}};
  for (const NamedGap& g : gaps) {
    table.rows.push_back({tight(g.sensor), number("{:.3f}", secondsBetween(origin, g.gap.t)),
                          number(g.gap.t), number(milliseconds(g.gap.duration_s)),
                          number(g.gap.missing)});
  }
  return table;
}

/// Every sensor's intervals over time, each over the median of its own.
Figure intervalFigure(const CalibrationRecord& record) {
  LinePlot plot;
  plot.frame = {"Interval since the sample before, over the sensor's median",
                {"time since the first frame [s]"},
                {"ratio [-]"},
                900,
                260};
  const TimeNs origin = timeOrigin(record);
  for (std::size_t i = 0; i < record.sample_intervals.size(); ++i) {
    Colour colour = seriesColour(i);
    colour.alpha = 210;
    plot.series.push_back({record.sample_intervals[i].sensor, {}, {}, colour, 1.2});
  }
  double largest = 0;
  for (const ShownInterval& shown : record.shown_intervals) {
    const auto sensor = static_cast<std::size_t>(shown.sensor);
    if (sensor >= plot.series.size()) continue;
    // Over the median, so that sensors of different rates share an axis.
    const double ratio = shown.interval_s / record.sample_intervals[sensor].median_s;
    plot.series[sensor].x.push_back(secondsBetween(origin, shown.t));
    plot.series[sensor].y.push_back(ratio);
    largest = std::max(largest, ratio);
  }
  // Up to 2 at least, where the first missing sample would stand.
  plot.frame.y.range = Range{0, std::max(2.0, 1.08 * largest)};
  return {toSvg(plot, "sample-intervals-plot"),
          "1 is an even stream; 2 and more are gaps, in which samples are missing; an interval "
          "above 1 next to one as far below 1 is one wrong stamp. In long streams only the "
          "shortest and the longest interval of each block are drawn.",
          true};
}

/// Differences from the median: in microseconds where all are below a millisecond.
Figure histogramFigure(const SampleIntervals& sensor, std::size_t index) {
  const IntervalHistogram& h = sensor.histogram;
  // The bins reach as far below the median as above it: the first edge tells how wide they are.
  const bool small = std::abs(h.first_s - sensor.median_s) < 1e-3;
  const double scale = small ? 1e6 : 1e3;
  const char* unit = small ? "\u00b5s" : "ms";
  Histogram plot;
  plot.frame = {sensor.sensor + ": distribution of intervals",
                {fmt::format("interval - median [{}]", unit)},
                {"intervals"},
                440,
                300};
  plot.first = scale * (h.first_s - sensor.median_s);
  plot.bin_width = scale * h.bin_s;
  plot.series = {{sensor.sensor, {h.counts.begin(), h.counts.end()}, seriesColour(index)}};
  std::string beyond = "All intervals are shown.";
  if (h.below + h.above > 0) {
    beyond = fmt::format("Off-scale: {} shorter, {} longer intervals.", grouped(h.below),
                         grouped(h.above));
  }
  return {toSvg(plot, fmt::format("sample-intervals-{}", index)),
          fmt::format("Median {} ms. {}", milliseconds(sensor.median_s), beyond)};
}

std::vector<Figure> intervalFigures(const CalibrationRecord& record) {
  std::vector<Figure> figures;
  if (!record.shown_intervals.empty()) figures.push_back(intervalFigure(record));
  for (std::size_t i = 0; i < record.sample_intervals.size(); ++i) {
    if (record.sample_intervals[i].histogram.counts.empty()) continue;
    figures.push_back(histogramFigure(record.sample_intervals[i], i));
  }
  return figures;
}

}  // namespace

Section intervalsSection(const CalibrationRecord& record) {
  Section section{"sample-intervals", "Sample intervals",
                  "By the sensors' own stamps. A gap is an interval above 1.5 times the median."};
  section.blocks.push_back({"", "", sensorTable(record.sample_intervals)});
  section = withFigures(std::move(section), intervalFigures(record));
  return withTable(std::move(section),
                   gapTable(longestGaps(record.sample_intervals), timeOrigin(record)),
                   "The longest gaps");
}

}  // namespace plumbline::html_internal
