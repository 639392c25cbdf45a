// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/statistics/several_tests.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "calibrator/base/statistics/distributions.h"
#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

/// The places of the values from the least to the largest.
std::vector<std::size_t> ascending(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
}

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

/// Ranks from 1 on, ties with the mean of theirs.
std::vector<double> midranks(const std::vector<double>& values) {
  const std::vector<std::size_t> order = ascending(values);
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    for (std::size_t j = i; j < end; ++j) ranks[order[j]] = static_cast<double>(i + end + 1) / 2;
    i = end;
  }
  return ranks;
}

}  // namespace

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

std::vector<double> holm(const std::vector<double>& p) {
  const std::vector<std::size_t> order = ascending(p);
  std::vector<double> corrected(p.size());
  double most = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    // The largest so far, so that no test is rejected after one that was not.
    most = std::max(most, static_cast<double>(p.size() - i) * p[order[i]]);
    corrected[order[i]] = std::min(1.0, most);
  }
  return corrected;
}

QuadeTest quade(const std::vector<std::vector<double>>& blocks) {
  assert(blocks.size() >= 2 && blocks.front().size() >= 2);
  const auto n = static_cast<double>(blocks.size());
  const std::size_t methods = blocks.front().size();
  const auto k = static_cast<double>(methods);
  std::vector<double> ranges;
  for (const auto& block : blocks) {
    const auto [least, most] = std::minmax_element(block.begin(), block.end());
    ranges.push_back(*most - *least);
  }
  const std::vector<double> weights = midranks(ranges);
  std::vector<double> sums(methods, 0);
  double total = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::vector<double> ranks = midranks(blocks[i]);
    for (std::size_t j = 0; j < methods; ++j) {
      // S_ij = Q_i (r_ij - (k + 1) / 2); F = (n - 1) B / (A - B) with A the sum of S_ij^2 (`total`)
      // and B = sum_j (sum_i S_ij)^2 / n (`between`).
      const double s = weights[i] * (ranks[j] - (k + 1) / 2);
      total += s * s;
      sums[j] += s;
    }
  }
  double between = 0;
  for (const double s : sums) between += s * s / n;
  QuadeTest test;
  test.dof1 = static_cast<int>(methods) - 1;
  test.dof2 = test.dof1 * (static_cast<int>(blocks.size()) - 1);
  if (total == 0) return test;  // all alike
  // F is infinite where all participants rank the methods alike and none weighs more (weights that
  // differ keep A - B above 0). Its distribution would say p = 0, which n participants cannot show.
  if (!(total - between > 1e-12 * total)) {
    test.statistic = std::numeric_limits<double>::infinity();
    test.p = std::pow(std::tgamma(k + 1), 1 - n);  // Conover: by chance all agree with the first
    return test;
  }
  test.statistic = (n - 1) * between / (total - between);
  test.p = fisherTail(test.dof1, test.dof2, test.statistic);
  return test;
}

std::vector<SurvivalPoint> kaplanMeier(std::vector<TimeToEvent> times) {
  std::sort(times.begin(), times.end(),
            [](const TimeToEvent& a, const TimeToEvent& b) { return a.t < b.t; });
  std::vector<SurvivalPoint> curve;
  double survival = 1;
  for (std::size_t i = 0; i < times.size();) {
    std::size_t end = i;
    int events = 0;
    for (; end < times.size() && times[end].t == times[i].t; ++end) events += times[end].done;
    // Those whose time is not before this one, events and censored ones alike.
    const auto at_risk = static_cast<int>(times.size() - i);
    // Where all are censored the curve does not fall: they only leave the numbers at risk.
    if (events > 0) {
      survival *= 1 - static_cast<double>(events) / at_risk;
      curve.push_back({times[i].t, at_risk, events, survival});
    }
    i = end;
  }
  return curve;
}

double restrictedMean(const std::vector<SurvivalPoint>& curve, double limit) {
  double area = 0, from = 0, height = 1;
  for (const SurvivalPoint& point : curve) {
    if (point.t >= limit) break;
    area += height * (point.t - from);
    from = point.t;
    height = point.survival;
  }
  return area + height * (limit - from);
}

std::optional<double> medianSurvival(const std::vector<SurvivalPoint>& curve) {
  for (const SurvivalPoint& point : curve) {
    // A product of fractions that is 1/2 may come out a rounding above it.
    if (point.survival <= 0.5 + 1e-12) return point.t;
  }
  return std::nullopt;
}

}  // namespace plumbline
