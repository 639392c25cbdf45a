// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/statistics/several_tests.h"

namespace plumbline {
namespace {

/// Probability of every sum of the ranks whose signs are positive, each sign as likely as the
/// other. Ranks are doubled, so that midranks are whole numbers.
std::vector<double> sumsOf(const std::vector<std::size_t>& doubled) {
  // One rank after the other is in the sum or not: all 2^n signs, without listing them.
  std::vector<double> density{1};
  for (const std::size_t rank : doubled) {
    std::vector<double> next(density.size() + rank, 0);
    for (std::size_t s = 0; s < density.size(); ++s) {
      next[s] += density[s] / 2;
      next[s + rank] += density[s] / 2;
    }
    density = std::move(next);
  }
  return density;
}

/// Twice the smaller tail, each with the observed sum in it: the distribution is discrete.
double twoSided(const std::vector<double>& density, std::size_t sum) {
  const auto at = density.begin() + static_cast<std::ptrdiff_t>(sum);
  const double below = std::accumulate(density.begin(), at + 1, 0.0);
  const double above = std::accumulate(at, density.end(), 0.0);
  return std::min(1.0, 2 * std::min(below, above));
}

/// V is also the number of Walsh averages above zero (Tukey, 1949), so the centres that the test
/// does not reject lie between two of their order statistics.
std::vector<double> walshAverages(const std::vector<double>& x) {
  std::vector<double> averages;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = i; j < x.size(); ++j) averages.push_back((x[i] + x[j]) / 2);
  }
  std::sort(averages.begin(), averages.end());
  return averages;
}

/// The number of Walsh averages below the interval: the least sum with more than `tail` at or under
/// it. None where even the least sum, 0, has more.
std::size_t outside(std::size_t n, double tail) {
  std::vector<std::size_t> ranks(n);
  std::iota(ranks.begin(), ranks.end(), std::size_t{1});
  const std::vector<double> density = sumsOf(ranks);
  double below = 0;
  for (std::size_t sum = 0; sum < density.size(); ++sum) {
    below += density[sum];
    if (below > tail) return sum;
  }
  return 0;
}

}  // namespace

std::vector<double> midranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    for (std::size_t j = i; j < end; ++j) ranks[order[j]] = static_cast<double>(i + end + 1) / 2;
    i = end;
  }
  return ranks;
}

SignedRank signedRank(const std::vector<double>& differences, double confidence) {
  assert(!differences.empty());
  std::vector<double> sizes, signs;
  for (const double d : differences) {
    if (d == 0) continue;
    sizes.push_back(std::abs(d));
    signs.push_back(d);
  }
  SignedRank result;
  std::vector<std::size_t> doubled;
  std::size_t sum = 0;
  const std::vector<double> ranks = midranks(sizes);
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    doubled.push_back(static_cast<std::size_t>(std::lround(2 * ranks[i])));
    if (signs[i] > 0) sum += doubled.back();
  }
  result.statistic = static_cast<double>(sum) / 2;
  if (!doubled.empty()) result.p = twoSided(sumsOf(doubled), sum);
  const std::vector<double> averages = walshAverages(differences);
  result.hodges_lehmann = median(averages);
  // By the distribution of n ranks without ties, zeros included, since every difference has its
  // Walsh averages; p is of the midranks that occurred. Where there are ties or zeros the two may
  // disagree about 0.
  const std::size_t left_out = outside(differences.size(), (1 - confidence) / 2);
  if (left_out > 0) {
    result.low = averages[left_out - 1];
    result.high = averages[averages.size() - left_out];
  }
  return result;
}

}  // namespace plumbline
