// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "evaluate/statistics/bootstrap.h"
#include "evaluate/statistics/several_tests.h"
#include "report/records/study_statistics.h"

namespace plumbline {

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
