// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/statistics/paired_analysis.h"

namespace plumbline {
namespace {

constexpr double kRounding = 1e-12;  // of the largest value: sums in another order are the same

/// The shifts at which permutations change sides; those that change nothing are only counted.
struct Crossings {
  std::vector<double> shifts;
  double unchanged = 0;
  bool exact = false;
  double total() const { return unchanged + static_cast<double>(shifts.size()); }
  /// Of a permutation that changes `count` values, whose differences add up to `sum`.
  void add(double sum, double count) {
    if (count == 0) {
      ++unchanged;
    } else {
      shifts.push_back(sum / count);
    }
  }
};

/// Number of subsets of k out of n; infinite where it is beyond a double.
double choose(std::size_t n, std::size_t k) {
  double count = 1;
  for (std::size_t i = 0; i < k; ++i) {
    count *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  }
  return std::round(count);
}

/// The values of both samples, and a mask of those that a permutation deals to x. It begins with
/// the ones in front, from where prev_permutation() visits every choice once.
class TwoGroups {
 public:
  TwoGroups(const std::vector<double>& x, const std::vector<double>& y) : first_(x.size()) {
    values_ = x;
    values_.insert(values_.end(), y.begin(), y.end());
    mask_.assign(values_.size(), 0);
    std::fill_n(mask_.begin(), first_, 1);
  }

  Crossings all() {
    Crossings crossings{{}, 0, true};
    do add(crossings);
    while (std::prev_permutation(mask_.begin(), mask_.end()));
    return crossings;
  }

  Crossings drawn(const PermutationOptions& options) {
    // The identity counts as drawn once, so that p is never 0 (Phipson, Smyth, 2010).
    Crossings crossings{{}, 1, false};
    RandomIndex random(options.seed);
    for (std::uint64_t i = 0; i < options.drawn; ++i) {
      // Fisher and Yates' shuffle by hand: std::shuffle draws differently in every standard
      // library.
      for (std::size_t j = mask_.size() - 1; j > 0; --j) std::swap(mask_[j], mask_[random(j + 1)]);
      add(crossings);
    }
    return crossings;
  }

 private:
  // The shift at which this permutation's mean difference equals the observed one.
  void add(Crossings& crossings) const {
    double left = 0, entered = 0, exchanged = 0;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (i < first_ && mask_[i] == 0) left += values_[i], ++exchanged;
      if (i >= first_ && mask_[i] == 1) entered += values_[i];
    }
    crossings.add(left - entered, exchanged);
  }

  std::size_t first_;
  std::vector<double> values_;
  std::vector<char> mask_;
};

/// All 2^n signs by the bits of a number, or drawn ones; the identity is among them.
Crossings flipped(const std::vector<double>& differences, const PermutationOptions& options) {
  std::vector<char> flips(differences.size(), 0);
  // The mean of the differences whose sign is turned.
  const auto add_to = [&](Crossings& crossings) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < differences.size(); ++i) {
      if (flips[i] != 0) sum += differences[i], ++count;
    }
    crossings.add(sum, count);
  };
  if (std::exp2(differences.size()) <= static_cast<double>(options.enumerated_up_to)) {
    Crossings crossings{{}, 0, true};
    for (std::uint64_t bits = 0; bits >> differences.size() == 0; ++bits) {
      for (std::size_t i = 0; i < flips.size(); ++i) flips[i] = static_cast<char>(bits >> i & 1U);
      add_to(crossings);
    }
    return crossings;
  }
  Crossings crossings{{}, 1, false};
  RandomIndex random(options.seed);
  for (std::uint64_t i = 0; i < options.drawn; ++i) {
    for (char& flip : flips) flip = static_cast<char>(random(2));
    add_to(crossings);
  }
  return crossings;
}

/// p and interval from the shifts at which permutations change sides: under no shift a permutation
/// is beyond the observed one where its crossing lies on that side of 0.
PermutationResult resultOf(double estimate, double rounding, Crossings crossings,
                           const PermutationOptions& options) {
  auto& shifts = crossings.shifts;
  // So that the interval ends at 0 exactly where p counts a shift as none.
  for (double& shift : shifts) shift = std::abs(shift) <= rounding ? 0 : shift;
  std::sort(shifts.begin(), shifts.end());
  const double total = crossings.total();
  // Shifts of zero are on both sides.
  const auto positive = std::upper_bound(shifts.begin(), shifts.end(), 0.0);
  const auto not_negative = std::lower_bound(shifts.begin(), shifts.end(), 0.0);
  const double above = crossings.unchanged + static_cast<double>(positive - shifts.begin());
  const double below = crossings.unchanged + static_cast<double>(shifts.end() - not_negative);
  // Twice the smaller tail: with groups of different sizes the distribution is not symmetric, and
  // the sizes of statistics could not be compared across its sides.
  PermutationResult result{
      estimate, std::min(1.0, 2 * std::min(above, below) / total), {}, {}, crossings.exact, total};
  // The least shift that is not rejected from below has more than `tail` permutations at or under
  // it.
  const double tail = total * (1 - options.confidence) / 2;
  // Permutations that change nothing are at every shift, so they use up part of the tail.
  const double rank = std::floor(tail * (1 + kRounding) - crossings.unchanged) + 1;
  if (rank >= 1 && rank <= static_cast<double>(shifts.size())) {
    const auto place = static_cast<std::size_t>(rank) - 1;
    result.low = shifts[place];
    result.high = shifts[shifts.size() - 1 - place];
  }
  return result;
}

/// The size that rounding is measured by.
double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

}  // namespace

void PermutationOptions::check() const {
  requireOption(confidence > 0 && confidence < 1, "confidence", confidence, "a value in (0, 1)");
  requireOption(drawn >= 1, "drawn", drawn, "at least 1");
}

PermutationResult shiftBetween(const std::vector<double>& x, const std::vector<double>& y,
                               const PermutationOptions& options) {
  assert(!x.empty() && !y.empty());
  options.check();
  TwoGroups groups(x, y);
  const bool few =
      choose(x.size() + y.size(), x.size()) <= static_cast<double>(options.enumerated_up_to);
  return resultOf(sampleStatistics(x).mean - sampleStatistics(y).mean,
                  kRounding * std::max(largest(x), largest(y)),
                  few ? groups.all() : groups.drawn(options), options);
}

PermutationResult shiftOfPairs(const std::vector<double>& differences,
                               const PermutationOptions& options) {
  assert(!differences.empty());
  options.check();
  return resultOf(sampleStatistics(differences).mean, kRounding * largest(differences),
                  flipped(differences, options), options);
}

}  // namespace plumbline
