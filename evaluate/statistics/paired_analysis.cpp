// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/statistics/paired_analysis.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

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
