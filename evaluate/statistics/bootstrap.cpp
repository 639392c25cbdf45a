// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <boost/math/distributions/normal.hpp>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/statistics/paired_analysis.h"

namespace plumbline {
namespace {

using Statistic = std::function<double(const Groups&)>;

/// Each group from itself, its size kept, as the design fixes how many began with which method.
std::vector<double> resampled(const Groups& groups, const Statistic& statistic,
                              const BootstrapOptions& options) {
  RandomIndex random(options.seed);
  Groups drawn = groups;
  std::vector<double> values(static_cast<std::size_t>(options.resamples));
  for (double& value : values) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (double& x : drawn[g]) x = groups[g][random(groups[g].size())];
    }
    value = statistic(drawn);
  }
  return values;
}

/// sum l^3 / (6 (sum l^2)^1.5) over the influences l of every value, those of a group divided by
/// its size.
double acceleration(const Groups& groups, const Statistic& statistic) {
  double cubes = 0, squares = 0;
  Groups left = groups;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto n = static_cast<double>(groups[g].size());
    std::vector<double> without;
    for (std::size_t i = 0; i < groups[g].size(); ++i) {
      left[g] = groups[g];
      left[g].erase(left[g].begin() + static_cast<std::ptrdiff_t>(i));
      without.push_back(statistic(left));
    }
    left[g] = groups[g];
    const double centre = sampleStatistics(without).mean;
    for (const double w : without) {
      // Jackknife influence (n - 1)(mean - w), over the group's size as the strata demand.
      const double influence = (n - 1) * (centre - w) / n;
      cubes += std::pow(influence, 3);
      squares += influence * influence;
    }
  }
  return squares > 0 ? cubes / (6 * std::pow(squares, 1.5)) : 0;
}

}  // namespace

void BootstrapOptions::check() const {
  requireOption(confidence > 0 && confidence < 1, "confidence", confidence, "a value in (0, 1)");
  requireOption(resamples >= 100, "resamples", resamples, "at least 100");
}

std::optional<BootstrapInterval> bcaInterval(const Groups& groups, const Statistic& statistic,
                                             const BootstrapOptions& options) {
  options.check();
  for (const auto& group : groups) {
    if (group.size() < 2) return std::nullopt;
  }
  const double estimate = statistic(groups);
  const std::vector<double> values = resampled(groups, statistic, options);
  // Values that equal the estimate count half: with few participants they are many.
  double below = 0;
  for (const double v : values) below += v < estimate ? 1 : v == estimate ? 0.5 : 0;
  const double share = below / static_cast<double>(values.size());
  // Outside of (0, 1) the bias is infinite: the statistic is never, or always, below its estimate.
  if (share <= 0 || share >= 1 ||
      *std::min_element(values.begin(), values.end()) ==
          *std::max_element(values.begin(), values.end())) {
    return std::nullopt;
  }
  const boost::math::normal_distribution<double> normal;
  // Efron's z0: how far the estimate is from the median of the resampled ones, in deviations.
  const double bias = quantile(normal, share);
  const double a = acceleration(groups, statistic);
  // Efron's BCa end: the quantile at Phi(z0 + (z0 + z_tail) / (1 - a (z0 + z_tail))).
  const auto end = [&](double tail) {
    const double z = bias + quantile(normal, tail);
    return plumbline::quantile(values, cdf(normal, bias + z / (1 - a * z)));
  };
  const double tail = (1 - options.confidence) / 2;
  return BootstrapInterval{estimate, end(tail), end(1 - tail)};
}

}  // namespace plumbline
