// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "evaluate/statistics/several_tests.h"
#include "report/records/study_statistics.h"

namespace plumbline {

/// Uniform indices whose sequence is the same with every standard library: mt19937_64 is fixed by
/// the standard, <random>'s distributions are not.
class RandomIndex {
 public:
  explicit RandomIndex(std::uint64_t seed) : engine_(seed) {}

  /// In [0, below), below < 2^32. The upper 32 bits scaled (Lemire): its bias, below / 2^32, is
  /// under any that a few hundred participants could show.
  std::size_t operator()(std::size_t below) {
    return static_cast<std::size_t>((engine_() >> 32U) * static_cast<std::uint64_t>(below) >> 32U);
  }

 private:
  std::mt19937_64 engine_;
};

struct BootstrapOptions {
  double confidence = 0.95;  ///< of the interval, (0, 1)
  int resamples = 20'000;
  std::uint64_t seed = 1;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

struct BootstrapInterval {
  double estimate = 0;
  double low = 0, high = 0;
};

/// Bias-corrected and accelerated bootstrap (Efron, 1987) of a statistic of independent groups,
/// which are resampled each within itself. The acceleration is that of the leave-one-out values
/// over all groups (each group's scaled by its size, Davison and Hinkley, 1997, eq. 5.25 and
/// ex. 3.5 for strata). Empty where a group has fewer than two values or nothing varies.
using Groups = std::vector<std::vector<double>>;
std::optional<BootstrapInterval> bcaInterval(const Groups& groups,
                                             const std::function<double(const Groups&)>& statistic,
                                             const BootstrapOptions& options = {});

struct PermutationOptions {
  double confidence = 0.95;              ///< of intervals, (0, 1)
  std::uint64_t enumerated_up_to = 2e5;  ///< permutations; above, random ones are drawn
  std::uint64_t drawn = 20'000;          ///< how many; the identity is one more
  std::uint64_t seed = 1;                ///< of the draws

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A test of "no shift" and the shifts that it does not reject.
struct PermutationResult {
  double estimate = 0;
  double p = 1;  ///< two-sided: twice the smaller one-sided p-value, at most 1
  /// Interval by inverting the two one-sided tests at (1 - confidence) / 2 each: it leaves out 0
  /// exactly where p <= 1 - confidence. An end is empty where no shift is rejected (few samples).
  std::optional<double> low, high;
  bool exact = false;       ///< every permutation was looked at
  double permutations = 0;  ///< that were, the identity included
};

/// Shift between two independent samples, mean(x) - mean(y). All ways of dealing the values out
/// into groups of the same sizes are equally likely under no shift (randomised groups: Fisher,
/// Pitman).
///
/// Shifted by delta, the permutation that exchanges k of x for k of y lies above the observed one
/// exactly where delta > (sum of x's k - sum of y's k) / k; so the interval's ends are order
/// statistics of these mean differences, and no search is needed. Both samples need a value.
PermutationResult shiftBetween(const std::vector<double>& x, const std::vector<double>& y,
                               const PermutationOptions& options = {});

/// Mean of differences that are symmetric about it: under no shift every sign is as likely as the
/// other. The interval's ends are order statistics of the means of all subsets (Hartigan, 1969).
/// Needs a value.
PermutationResult shiftOfPairs(const std::vector<double>& differences,
                               const PermutationOptions& options = {});

/// One participant under two methods, on the scale of the analysis (the logarithm for ratios).
struct PairedValues {
  double baseline = 0, method = 0;
  bool method_first = false;  ///< order of the two sessions
};

struct PairedOptions {
  PermutationOptions permutation;
  BootstrapOptions bootstrap;
};

/// What pairs say of a method, effects as method - baseline.
struct PairedAnalysis {
  StudyDesign design = StudyDesign::kTooFew;
  int first_baseline = 0, first_method = 0;  ///< participants by order
  PermutationResult effect;
  std::optional<BootstrapInterval> bca;
  SignedRank signed_rank;                   ///< of method - baseline; no period in it
  std::optional<PermutationResult> period;  ///< second session - first, method taken out
  std::optional<PermutationResult> carry_over;
};

/// Two methods, two periods (Jones and Kenward, 2014, ch. 2; Koch, 1972). With c = method -
/// baseline of a participant, whose mean is tau + pi where the baseline came first and tau - pi
/// where the method did:
///   tau = (mean c_M + mean c_B) / 2,   pi = (mean c_B - mean c_M) / 2
/// over those who began with the method (M) and with the baseline (B). Under tau = 0 the
/// differences first - second, c_M and -c_B, are of one distribution: which participant had which
/// order is permuted, the groups' sizes kept, as the orders were dealt out. (Exchanging the methods
/// within a participant would be right only without an effect of the period.) The carry-over is the
/// difference of the participants' sums, mean over M - mean over B.
///
/// Where all have one order, tau and pi cannot be told apart: the effect is that of both, its
/// interval by permuting signs, and its p-values are none of the method's. Fewer than two pairs:
/// too few, and nothing else is set. At least one pair.
PairedAnalysis analysePairs(const std::vector<PairedValues>& pairs, const PairedOptions& options);

}  // namespace plumbline
