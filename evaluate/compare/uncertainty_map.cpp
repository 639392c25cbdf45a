// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/uncertainty_map.h"

#include <cassert>
#include <cmath>

namespace plumbline {

std::vector<double> uncertaintyMap(const Intrinsics& camera, const ProjectionCovariance& covariance,
                                   double range_m, const ImageGrid& grid) {
  std::vector<double> map;
  map.reserve(static_cast<std::size_t>(grid.size()));
  for (int i = 0; i < grid.size(); ++i) {
    const auto C = pixelCovariance(camera, covariance, grid.pixel(camera.resolution, i), range_m);
    map.push_back(C ? worstDirectionStd(*C) : std::nan(""));
  }
  return map;
}

std::vector<double> differenceWeights(const std::vector<double>& std_A,
                                      const std::vector<double>& std_B) {
  assert(std_A.size() == std_B.size());
  std::vector<double> weights;
  for (std::size_t i = 0; i < std_A.size(); ++i) {
    const double w = 1 / (std_A[i] * std_B[i]);
    weights.push_back(w * w);
  }
  return weights;
}

}  // namespace plumbline
