// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace plumbline {

double quantile(std::vector<double> values, double q) {
  assert(!values.empty() && q >= 0 && q <= 1);
  const double position = q * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(std::floor(position));
  std::nth_element(values.begin(), values.begin() + low, values.end());
  const double below = values[low];
  if (low + 1 >= values.size()) return below;
  const double above = *std::min_element(values.begin() + low + 1, values.end());
  return below + (position - static_cast<double>(low)) * (above - below);
}

ErrorStatistics summariseErrors(const std::vector<Eigen::Vector2d>& errors) {
  ErrorStatistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  const double n = static_cast<double>(errors.size());
  std::vector<double> norms;
  norms.reserve(errors.size());
  double squared = 0;
  for (const Eigen::Vector2d& e : errors) {
    norms.push_back(e.norm());
    s.mean_px += norms.back() / n;
    s.axis_mean_px += e / n;
    squared += e.squaredNorm();
  }
  double variance = 0;
  Eigen::Vector2d axis_variance = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < errors.size(); ++i) {
    variance += (norms[i] - s.mean_px) * (norms[i] - s.mean_px) / n;
    axis_variance += (errors[i] - s.axis_mean_px).cwiseAbs2() / n;
  }
  s.rmse_px = std::sqrt(squared / n);
  s.std_px = std::sqrt(variance);
  s.axis_std_px = axis_variance.cwiseSqrt();
  s.median_px = quantile(std::move(norms), 0.5);
  return s;
}

}  // namespace plumbline
