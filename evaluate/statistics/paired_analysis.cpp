// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/statistics/paired_analysis.h"

#include <algorithm>
#include <cmath>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/distributions.h"
#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

/// The shift between c_M and -c_B is mean c_M + mean c_B, twice the effect; that between c_B and
/// c_M twice that of the period.
PermutationResult halved(PermutationResult result) {
  result.estimate /= 2;
  if (result.low) *result.low /= 2;
  if (result.high) *result.high /= 2;
  return result;
}

std::vector<double> negated(std::vector<double> values) {
  for (double& v : values) v = -v;
  return values;
}

/// Values that differ by their rounding are equal: the sign of what is left would be taken for one.
double differenceOf(const PairedValues& pair) {
  const double difference = pair.method - pair.baseline;
  const double size = std::max(std::abs(pair.method), std::abs(pair.baseline));
  return std::abs(difference) <= 1e-12 * size ? 0 : difference;
}

/// The effect of groups c_M and c_B, each group counting alike whatever its size, as in the
/// crossover's estimate.
double meanOfMeans(const Groups& groups) {
  double sum = 0;
  for (const auto& group : groups) sum += sampleStatistics(group).mean;
  return sum / static_cast<double>(groups.size());
}

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
  // Efron's z0: how far the estimate is from the median of the resampled ones, in deviations.
  const double bias = normalQuantile(share);
  const double a = acceleration(groups, statistic);
  // Efron's BCa end: the quantile at Phi(z0 + (z0 + z_tail) / (1 - a (z0 + z_tail))).
  const auto end = [&](double tail) {
    const double z = bias + normalQuantile(tail);
    return quantile(values, normalShare(bias + z / (1 - a * z)));
  };
  const double tail = (1 - options.confidence) / 2;
  return BootstrapInterval{estimate, end(tail), end(1 - tail)};
}

PairedAnalysis analysePairs(const std::vector<PairedValues>& pairs, const PairedOptions& options) {
  std::vector<double> all, method_first, baseline_first, sums_method, sums_baseline;
  for (const PairedValues& pair : pairs) {
    const double difference = differenceOf(pair);
    all.push_back(difference);
    (pair.method_first ? method_first : baseline_first).push_back(difference);
    (pair.method_first ? sums_method : sums_baseline).push_back(pair.method + pair.baseline);
  }
  PairedAnalysis result;
  result.first_method = static_cast<int>(method_first.size());
  result.first_baseline = static_cast<int>(baseline_first.size());
  if (pairs.size() < 2) return result;
  result.signed_rank = signedRank(all, options.permutation.confidence);
  // Without one of the groups nothing tells the method from the period.
  if (method_first.empty() || baseline_first.empty()) {
    result.design = StudyDesign::kOneOrder;
    result.effect = shiftOfPairs(all, options.permutation);
    result.bca = bcaInterval({all}, meanOfMeans, options.bootstrap);
    return result;
  }
  result.design = StudyDesign::kCrossover;
  result.effect = halved(shiftBetween(method_first, negated(baseline_first), options.permutation));
  result.bca = bcaInterval({method_first, baseline_first}, meanOfMeans, options.bootstrap);
  result.period = halved(shiftBetween(baseline_first, method_first, options.permutation));
  // Each method and each period is once in every sum, so that the groups' sums differ by carry-over
  // alone (Jones and Kenward, 2014, ch. 2). It compares people with people, and its interval is
  // mostly much wider than that of the effect, which is within people.
  result.carry_over = shiftBetween(sums_method, sums_baseline, options.permutation);
  return result;
}

}  // namespace plumbline
