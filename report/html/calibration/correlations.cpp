// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/html/calibration/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

/// "-.61": as short as a cell of many needs; what rounds to zero has no sign.
std::string shortNumber(double rho) {
  std::string text = fmt::format("{:.2f}", std::abs(rho) < 0.005 ? 0 : rho);
  const std::size_t zero = text.find('0');
  return zero < text.find('.') ? text.erase(zero, 1) : text;
}

std::vector<Figure> correlationFigures(const StageView& stage) {
  const ParameterCovariance& covariance = stage.summary.covariance;
  const auto n = static_cast<int>(covariance.names.size());
  if (n == 0 || covariance.matrix.rows() != n) return {};
  HeatMap map;
  // 30 px for a parameter, beside its name and the colour bar.
  const int width = std::clamp(230 + 30 * n, 420, 960);
  const Range all{0, static_cast<double>(n)};
  map.frame = {stage.title, {"", all, {}, false, true}, {"", all, {}, true}, width, width - 90,
               true};
  map.columns = map.rows = n;
  map.colours = ColourMap::kDiverging;
  map.value_range = Range{-1, 1};
  map.value_label = "correlation";
  for (int i = 0; i < n; ++i) {
    map.frame.x.ticks.push_back({i + 0.5, covariance.names[static_cast<std::size_t>(i)]});
    for (int j = 0; j < n; ++j) {
      const double scale = std::sqrt(covariance.matrix(i, i) * covariance.matrix(j, j));
      // Without a variance there is no correlation.
      const double rho = scale > 0 ? covariance.matrix(i, j) / scale : std::nan("");
      map.values.push_back(rho);
      // Of many, only those that are worth a look: figures in all cells would hide them.
      const bool shown = std::isfinite(rho) && (n <= 8 || (i != j && std::abs(rho) >= 0.3));
      map.cell_labels.push_back(shown ? shortNumber(rho) : "");
    }
  }
  map.frame.y.ticks = map.frame.x.ticks;
  return {{toSvg(map, stage.id + "-correlation"),
           "Near 1 or -1, two parameters can compensate each other: their combination is known "
           "better than their standard deviations state, and more varied views (tilt, distance, "
           "edges) would separate them.",
           n > 8}};
}

}  // namespace

Section correlationSection(const CalibrationRecord& record) {
  Section section{
      "correlations", "Correlations",
      fmt::format(
          "Correlations of the estimates, for a corner noise of {:g} px per coordinate and with "
          "all poses and states marginalised. Their entropy is 0.5 log((2\u03c0e)\u207f |\u03a3|); "
          "compare it only under the same parameters, units and noise.",
          record.assumptions.pixel_sigma_px)};
  if (record.camera) {
    section = withFigures(std::move(section), correlationFigures(cameraView(record)));
  }
  if (!record.camera_imu) return section;
  return withFigures(std::move(section), correlationFigures(cameraImuView(record)));
}

}  // namespace plumbline::html_internal
