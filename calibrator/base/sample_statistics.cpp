// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/sample_statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace plumbline {
namespace {

/// The q-quantile of ascending values by linear interpolation (type 7).
double quantileOfSorted(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(position);
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (position - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace

SampleStatistics sampleStatistics(std::vector<double> values, int ddof) {
  assert(ddof == 0 || ddof == 1);
  SampleStatistics s;
  s.n = values.size();
  if (values.empty()) return s;
  const auto n = static_cast<double>(values.size());
  for (const double x : values) {
    s.mean += x / n;
    s.sse += x * x;
  }
  s.rmse = std::sqrt(s.sse / n);
  double spread = 0;
  for (const double x : values) spread += (x - s.mean) * (x - s.mean);
  if (n > ddof) s.std = std::sqrt(spread / (n - ddof));
  std::sort(values.begin(), values.end());
  s.min = values.front();
  s.max = values.back();
  s.median = quantileOfSorted(values, 0.5);
  for (std::size_t i = 0; i < kPercents.size(); ++i) {
    s.percentiles[i] = quantileOfSorted(values, kPercents[i] / 100);
  }
  return s;
}

}  // namespace plumbline
