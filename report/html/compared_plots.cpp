// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/figure.h"

namespace plumbline::html_internal {
namespace {

constexpr double kColoured = 0.98;  // share of the cells below the end of the colours
constexpr double kTypical = 0.9;    // share of the arrows below the typical one
constexpr double kLongest = 2;      // of a typical arrow

double lengthOf(const FieldArrow& arrow) { return std::hypot(arrow.dx, arrow.dy); }

/// To 1, 2 or 5 times a power of ten: a length that a reader takes in.
double roundedDown(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= value) return factor * power;
  }
  return power;
}

}  // namespace

// From 0 to a quantile of all maps together: a few wild cells, as at the corners of an image, would
// leave one colour for all others.
void scaleAlike(const std::vector<HeatMap*>& maps) {
  std::vector<double> known;
  for (const HeatMap* map : maps) {
    std::copy_if(map->values.begin(), map->values.end(), std::back_inserter(known),
                 [](double v) { return std::isfinite(v); });
  }
  // The floor keeps the scale of maps that are all zero from having no length.
  const double end = known.empty() ? 1 : std::max(1e-9, quantile(std::move(known), kColoured));
  for (HeatMap* map : maps) map->value_range = Range{0, end};
}

std::string clampText(const HeatMap& map) {
  double largest = 0;
  for (const double v : map.values) {
    if (std::isfinite(v)) largest = std::max(largest, v);
  }
  if (!map.value_range || largest <= map.value_range->max) return "";
  return fmt::format(" Colours end at {:.2g} px; the largest is {:.2g} px.", map.value_range->max,
                     largest);
}

// One magnification, so that arrows of different fields compare by eye. What is longer than twice a
// typical arrow is cut, lest it lie across its neighbours.
void magnifyAlike(const std::vector<VectorField*>& fields, double reach) {
  std::vector<double> lengths;
  for (const VectorField* field : fields) {
    for (const FieldArrow& arrow : field->arrows) lengths.push_back(lengthOf(arrow));
  }
  // The floor likewise: what follows divides by it.
  const double typical =
      lengths.empty() ? 1 : std::max(1e-9, quantile(std::move(lengths), kTypical));
  for (VectorField* field : fields) {
    field->magnification = reach / typical;
    field->longest = kLongest * typical;
    field->reference = roundedDown(typical);
    field->reference_label = fmt::format("{:g} px", field->reference);
  }
}

std::string cutText(const VectorField& field) {
  const auto cut = std::count_if(field.arrows.begin(), field.arrows.end(),
                                 [&](const auto& a) { return lengthOf(a) > field.longest; });
  if (field.longest <= 0 || cut == 0) return "";
  return fmt::format(" {} arrow{} above {:.2g} px {} shortened to that length, in red.", cut,
                     cut == 1 ? "" : "s", field.longest, cut == 1 ? "is" : "are");
}

}  // namespace plumbline::html_internal
