// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/figure.h"
#include "report/html/replay/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr double kShownShare = 0.95;  // of the values; kAbove states what is left out
constexpr const char* kSeeds =
    " Where an order was drawn with several seeds, dashed lines bound the band between the "
    "quartiles.";
constexpr const char* kAbove = " The highest 5 % of the values are off-scale.";

using Bands = std::vector<CounterfactualBand>;
using BandColumn = std::vector<std::optional<Quartiles>> CounterfactualBand::*;

/// `series` with one of the quartiles over the number of views; a gap where not every seed has a
/// value.
Series withQuartile(Series series, const CounterfactualBand& band, BandColumn column,
                    double Quartiles::*part) {
  const auto& values = band.*column;
  for (std::size_t i = 0; i < std::min(band.views.size(), values.size()); ++i) {
    // Logarithmic, for errors fall by ratios of views.
    series.x.push_back(std::log10(std::max(1, band.views[i])));
    series.y.push_back(values[i] ? (*values[i]).*part : std::numeric_limits<double>::quiet_NaN());
  }
  return series;
}

/// The median over the seeds, between dashed lines at the quartiles.
void addBand(LinePlot& plot, const CounterfactualBand& band, BandColumn column, std::size_t place) {
  const Colour colour = seriesColour(place);
  std::string name = band.strategy;
  if (band.seeds > 1) {
    name += fmt::format(" (median of {})", band.seeds);
    // First, so that the median lies over them.
    const Series dashed{"", {}, {}, {colour.red, colour.green, colour.blue, 160}, 1, true};
    plot.series.push_back(withQuartile(dashed, band, column, &Quartiles::lower));
    plot.series.push_back(withQuartile(dashed, band, column, &Quartiles::upper));
  }
  plot.series.push_back(withQuartile({name, {}, {}, colour, 2}, band, column, &Quartiles::median));
}

Range rangeShown(const LinePlot& plot) {
  std::vector<double> values;
  for (const Series& s : plot.series) addFinite(s.y, values);
  if (values.empty()) return {0, 1};
  // Down to the least: what an order ends at is what is compared.
  const double low = *std::ranges::min_element(values);
  const double high = std::max(quantile(values, kShownShare), low + 1e-9);
  return {low - 0.06 * (high - low), high + 0.06 * (high - low)};
}

/// 1, 2, 5, 10, ... on the logarithmic axis.
std::vector<AxisTick> viewTicks(const Range& range) {
  std::vector<AxisTick> ticks;
  for (int power = 0; power <= 6; ++power) {
    for (const int first : {1, 2, 5}) {
      const double views = first * std::pow(10, power);
      const double at = std::log10(views);
      if (at >= range.min && at <= range.max) ticks.push_back({at, fmt::format("{:g}", views)});
    }
  }
  return ticks;
}

/// In log10 of views, over all orders.
Range viewRange(const Bands& bands) {
  int least = std::numeric_limits<int>::max(), most = 2;
  for (const CounterfactualBand& b : bands) {
    if (b.views.empty()) continue;
    least = std::min(least, std::max(1, b.views.front()));
    most = std::max(most, b.views.back());
  }
  // Never without length, which the axis divides by.
  return {std::log10(std::min(least, most - 1)), std::log10(most)};
}

/// One colour a strategy, in all figures.
std::size_t placeOf(const std::string& strategy) {
  static const char* const kKnown[] = {"recorded", "random", "greedy-mi",
                                       "coverage", "guide",  "predicted-error"};
  std::size_t place = 0;
  // One that is not known has the colour after the last.
  while (place < std::size(kKnown) && strategy != kKnown[place]) ++place;
  return place;
}

struct BandFigure {
  const char* id;
  std::string title;
  const char* y_label;
  BandColumn column;
  std::optional<double> full_pool;
  std::string caption;
};

Figure bandFigure(const Bands& bands, const BandFigure& what) {
  LinePlot plot;
  const Range views = viewRange(bands);
  plot.frame = {what.title,
                {"views used", views, viewTicks(views), false, false, true},
                {what.y_label},
                960,
                380};
  for (const CounterfactualBand& band : bands) {
    addBand(plot, band, what.column, placeOf(band.strategy));
  }
  if (what.full_pool) {
    plot.series.push_back({"all of the pool",
                           {views.min, views.max},
                           {*what.full_pool, *what.full_pool},
                           {90, 98, 110, 255},
                           1,
                           true});
  }
  const Range shown = rangeShown(plot);
  plot.frame.y.range = shown;
  const bool above = std::ranges::any_of(plot.series, [&](const Series& s) {
    return std::ranges::any_of(s.y, [&](double y) { return y > shown.max; });
  });
  return {toSvg(plot, what.id), what.caption + kSeeds + (above ? kAbove : ""), true};
}

/// "14 (12 to 17)": median and quartiles.
std::string neededText(const CounterfactualBand& band) {
  if (!band.views_needed) return notNeededText(band);
  const Quartiles& q = *band.views_needed;
  if (band.seeds < 2) return fmt::format("{:g}", q.median);
  return fmt::format("{:g} ({:g} to {:g})", q.median, q.lower, q.upper);
}

/// What an order ends at, with all its views: the median over its seeds.
std::string lastText(const CounterfactualBand& band, BandColumn column) {
  const auto& values = band.*column;
  return values.empty() || !values.back() ? kDash : fmt::format("{:.4g}", values.back()->median);
}

/// Over the numbers of views, of the regret of the median over seeds.
std::string medianRegret(const CounterfactualBand& band) {
  std::vector<double> known;
  for (const auto& value : band.regret_px) {
    if (value && std::isfinite(*value)) known.push_back(*value);
  }
  return known.empty() ? kDash : fmt::format("{:.4f}", quantile(known, 0.5));
}

Table strategyTable(const Bands& bands) {
  Table table{{words("Order"), number("Seeds"), number("Most views"),
               number("Views to come within 10 %"), number("Median regret [px]"),
               number("Last entropy [nats]"), number("Last held-out RMSE [px]")}};
  for (const CounterfactualBand& b : bands) {
    table.rows.push_back({tight(b.strategy), number(b.seeds),
                          number(b.views.empty() ? kDash : std::to_string(b.views.back())),
                          number(neededText(b)), number(medianRegret(b)),
                          number(lastText(b, &CounterfactualBand::entropy_nats)),
                          number(lastText(b, &CounterfactualBand::held_out_px))});
  }
  return table;
}

void addFigures(Section& section, const Counterfactuals& c) {
  const auto add = [&](const Bands& bands, const BandFigure& what) {
    section.blocks.push_back(figureBlock("", {bandFigure(bands, what)}));
  };
  add(c.bands, {"replay-entropy", "Entropy over views", "entropy [nats]",
                &CounterfactualBand::entropy_nats, c.full_pool_entropy_nats,
                "Entropy of the calibration parameters over the number of views."});
  add(c.bands, {"replay-held-out", "Held-out error over views", "held-out RMSE [px]",
                &CounterfactualBand::held_out_px, c.full_pool_held_out_px,
                "Reprojection RMSE on held-out frames, with only their poses estimated."});
  if (c.other_model_bands.empty()) return;
  add(c.other_model_bands,
      {"replay-other-model", "Held-out error with " + c.other_model, "held-out RMSE [px]",
       &CounterfactualBand::held_out_px, std::nullopt,
       "The same frames, with orders computed under another camera model: a larger gain than above "
       "means that the misfit of the first model had reduced it."});
}

}  // namespace

Section counterfactualsSection(const ReplayRecord& record) {
  Section section{
      "counterfactuals", "Counterfactuals",
      "The same frames in other orders: how many views would have been enough for the same error?"};
  if (!record.counterfactuals) return section;
  const Counterfactuals& c = *record.counterfactuals;
  section.remarks = c.remarks;
  if (!c.problem.empty()) section.blocks.push_back({"", c.problem});
  if (c.bands.empty()) return section;
  section.lead += fmt::format(
      " The pool contains {} frames, {} others are held out; with all of the pool the entropy is "
      "{:.3f} nats and the held-out RMSE {:.4f} px. Views are counted until an order comes within "
      "10 % of that RMSE and stays there; regret is an order's held-out RMSE minus that of the "
      "best order with as many views, in the median over the numbers of views.",
      c.pool_frames, c.held_out_frames, c.full_pool_entropy_nats, c.full_pool_held_out_px);
  section = withTable(std::move(section), strategyTable(c.bands));
  addFigures(section, c);
  return section;
}

}  // namespace plumbline::html_internal
