// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/statistics/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace plumbline {
namespace {

/// The q-quantile of ascending values (type 7). A position on a value needs no neighbour, which may
/// be infinite; between two infinite values there is no difference to take a share of.
double quantileOfSorted(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(position);
  // 0 also at the last value, which has no neighbour.
  const double share = position - static_cast<double>(low);
  if (share == 0 || sorted[low] == sorted[low + 1]) return sorted[low];
  return sorted[low] + share * (sorted[low + 1] - sorted[low]);
}

/// Of SampleStatistics what no order is needed for.
SampleStatistics momentsOf(const std::vector<double>& values, int ddof) {
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
  // In a second pass: sse - n mean^2 would cancel where values lie close about a large mean.
  for (const double x : values) spread += (x - s.mean) * (x - s.mean);
  if (n > ddof) s.std = std::sqrt(spread / (n - ddof));
  return s;
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  assert(!values.empty() && q >= 0 && q <= 1);
  // Two order statistics, not a sort: medians of all corners' errors are taken often.
  const auto low = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(low);
  std::nth_element(values.begin(), at, values.end());
  // The neighbour above is the least of what nth_element() left behind.
  if (at + 1 != values.end()) std::iter_swap(at + 1, std::min_element(at + 1, values.end()));
  return quantileOfSorted(values, q);
}

ErrorStatistics summariseErrors(const std::vector<Eigen::Vector2d>& errors) {
  ErrorStatistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  const double n = static_cast<double>(errors.size());
  std::vector<double> norms;
  norms.reserve(errors.size());
  for (const Eigen::Vector2d& e : errors) {
    norms.push_back(e.norm());
    s.axis_mean_px += e / n;
  }
  Eigen::Vector2d axis_variance = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& e : errors) axis_variance += (e - s.axis_mean_px).cwiseAbs2() / n;
  s.axis_std_px = axis_variance.cwiseSqrt();
  const SampleStatistics of_norms = momentsOf(norms, 0);
  s.rmse_px = of_norms.rmse;
  s.mean_px = of_norms.mean;
  s.std_px = of_norms.std;
  s.median_px = median(std::move(norms));
  return s;
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

SampleStatistics sampleStatistics(std::vector<double> values, int ddof) {
  assert(ddof == 0 || ddof == 1);
  SampleStatistics s = momentsOf(values, ddof);
  if (values.empty()) return s;
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
