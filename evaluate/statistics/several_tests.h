// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace plumbline {

/// Wilcoxon's signed rank test of differences that are symmetric about their centre.
struct SignedRank {
  double statistic = 0;       ///< V: sum of the ranks of positive differences
  double p = 1;               ///< two-sided and exact: every sign of the (mid)ranks that occurred
  double hodges_lehmann = 0;  ///< median of the Walsh averages (x_i + x_j) / 2, i <= j
  std::optional<double> low, high;  ///< of the centre; empty where n is too small for any
};

/// Differences of zero carry no sign and are left out of the test (Wilcoxon), not of the estimate.
/// Ties have the mean of their ranks, and the distribution is that of these ranks. The interval's
/// ends are order statistics of the Walsh averages by the distribution without ties. Not empty.
SignedRank signedRank(const std::vector<double>& differences, double confidence = 0.95);

/// Holm's step-down correction: p_(i) becomes max over j <= i of (m - j + 1) p_(j), at most 1. In
/// the order given.
std::vector<double> holm(const std::vector<double>& p);

/// Quade's test that k methods do not differ.
struct QuadeTest {
  double statistic = 0;    ///< F; infinite where the weighted ranks agree throughout
  int dof1 = 0, dof2 = 0;  ///< k - 1, (k - 1) (n - 1)
  double p = 1;
};

/// blocks[i][j]: participant i under method j. Ranks within a participant are weighted by the rank
/// of the participant's range (Quade, 1979). At least 2 participants and 2 methods, rows of one
/// length.
QuadeTest quade(const std::vector<std::vector<double>>& blocks);

/// A time until done; `done` false: it ended without (censored).
struct TimeToEvent {
  double t = 0;
  bool done = true;
};

/// A step of the survival curve.
struct SurvivalPoint {
  double t = 0;
  int at_risk = 0;      ///< just before t
  int events = 0;       ///< at t
  double survival = 1;  ///< from t on
};

/// Kaplan and Meier's product limit S(t) = prod_{t_i <= t} (1 - d_i / n_i); one point per distinct
/// time of an event. Censored ones at a time of an event are at risk there.
std::vector<SurvivalPoint> kaplanMeier(std::vector<TimeToEvent> times);

/// Area below the curve from 0 to `limit`. Where the last ones are censored before the limit the
/// curve goes on at its last height.
double restrictedMean(const std::vector<SurvivalPoint>& curve, double limit);

/// The first time at which the curve is at 1/2 or below.
std::optional<double> medianSurvival(const std::vector<SurvivalPoint>& curve);

}  // namespace plumbline
