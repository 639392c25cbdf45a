// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/statistics/several_tests.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include <boost/math/distributions/fisher_f.hpp>

namespace plumbline {

std::vector<double> holm(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
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
  test.p = cdf(complement(boost::math::fisher_f(test.dof1, test.dof2), test.statistic));
  return test;
}

}  // namespace plumbline
