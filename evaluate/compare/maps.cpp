// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "evaluate/compare/compare_calibrations.h"

namespace plumbline {
namespace {

// A border on either side and a centre between.
constexpr int kFewestGridPoints = 3;
constexpr int kMostGridPoints = 500;

/// Ranges are compared exactly: both maps are made for the same list of options, infinity included.
const ImageMap* find(const std::vector<ImageMap>& maps, const std::string& label,
                     const std::string& camera, double range_m) {
  const auto found = std::find_if(maps.begin(), maps.end(), [&](const ImageMap& m) {
    return m.label == label && m.camera == camera && m.range_m == range_m;
  });
  return found == maps.end() ? nullptr : &*found;
}

/// Whether weights leave enough points for a fit. Deviations of 0 and unknown ones leave none.
bool canWeight(const std::vector<double>& weights) {
  return std::count_if(weights.begin(), weights.end(),
                       [](double w) { return std::isfinite(w) && w > 0; }) >= kFewestFitRays;
}

/// Undefined all over where too few pixels of the fit have a ray under both: without a map nobody
/// would miss it.
ImageMap differenceMap(const CameraCalibration& a, const CameraCalibration& b,
                       const std::string& label, const DifferenceOptions& options) {
  const auto difference = projectionDifference(a.intrinsics, b.intrinsics, options);
  ImageMap map = imageMapOf(a, label, options.range_m, options.grid);
  if (!difference) {
    map.method = "no fit: fewer than three pixels have a ray under both";
    map.values.assign(static_cast<std::size_t>(options.grid.size()), std::nan(""));
    return map;
  }
  map.method =
      options.weights.empty() ? "fit over the focus region" : "fit weighted by uncertainty";
  map.implied = difference->T_BA;
  map.vectors = difference->vectors;
  for (const Eigen::Vector2d& v : map.vectors) map.values.push_back(v.norm());
  return map;
}

}  // namespace

void MapOptions::check() const {
  if (!(focus_radius_px >= 0) || std::isinf(focus_radius_px)) {
    throw InputError(fmt::format("a focus radius of {} px: expected 0 or more", focus_radius_px));
  }
  for (const int n : {grid.columns, grid.rows}) {
    if (n >= kFewestGridPoints && n <= kMostGridPoints) continue;
    throw InputError(fmt::format("a grid of {}x{}: expected {} to {} columns and rows",
                                 grid.columns, grid.rows, kFewestGridPoints, kMostGridPoints));
  }
  for (const double range : ranges_m) {
    if (range > 0) continue;
    throw InputError(fmt::format("points at {} m: expected a positive distance", range));
  }
}

void MapOptions::checkFocus(const Resolution& image) const {
  DifferenceOptions unweighted;
  unweighted.grid = grid;
  unweighted.focus_radius_px = focus_radius_px;
  const int points = pointsInFocus(image, unweighted);
  if (points >= kFewestFitRays) return;
  throw InputError(
      fmt::format("only {} of the {}x{} points over images of {}x{} pixels are within the focus "
                  "radius, and the alignment needs {}; choose a finer --grid or a larger "
                  "--focus-radius",
                  points, grid.columns, grid.rows, image.width, image.height, kFewestFitRays));
}

std::vector<double> differenceWeights(const std::vector<double>& std_A,
                                      const std::vector<double>& std_B) {
  assert(std_A.size() == std_B.size());
  std::vector<double> weights;
  for (std::size_t i = 0; i < std_A.size(); ++i) {
    // 1 / (var_A var_B): a pixel counts where both know it, and falls out where either does not
    // (NaN).
    const double w = 1 / (std_A[i] * std_B[i]);
    weights.push_back(w * w);
  }
  return weights;
}

std::vector<ImageMap> differenceMaps(const ComparedCalibration& a, const ComparedCalibration& b,
                                     const std::vector<ImageMap>& uncertainties,
                                     const MapOptions& options) {
  std::vector<ImageMap> maps;
  const auto& cameras_a = a.calibration.cameras;
  const auto& cameras_b = b.calibration.cameras;
  for (std::size_t c = 0; c < std::min(cameras_a.size(), cameras_b.size()); ++c) {
    // Other sizes are a finding of their own (comparisonFindings()).
    if (!(cameras_a[c].intrinsics.resolution == cameras_b[c].intrinsics.resolution)) continue;
    for (const double range : options.ranges_m) {
      DifferenceOptions difference{range, options.grid, options.focus_radius_px, {}, options.fit};
      const ImageMap* std_a = find(uncertainties, a.label, cameras_a[c].name, range);
      const ImageMap* std_b = find(uncertainties, b.label, cameras_b[c].name, range);
      // A focus radius asked for takes the place of the weights.
      if (options.focus_radius_px == 0 && std_a && std_b) {
        difference.weights = differenceWeights(std_a->values, std_b->values);
        if (!canWeight(difference.weights)) difference.weights.clear();
      }
      if (difference.weights.empty()) options.checkFocus(cameras_a[c].intrinsics.resolution);
      const std::string label = fmt::format("{} - {}", b.label, a.label);
      maps.push_back(differenceMap(cameras_a[c], cameras_b[c], label, difference));
    }
  }
  return maps;
}

}  // namespace plumbline
