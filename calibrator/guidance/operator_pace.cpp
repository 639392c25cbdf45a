// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/operator_pace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

// Share by which a later candidate must be better. Before a flat square board a view and its twin a
// quarter turn further gain the same but for rounding: up to 1e-12 of the gain in recordings, where
// the best views that differ are 1e-5 apart or more.
constexpr double kEqualShare = 1e-6;

/// Appends the indices of `scores` from the best to the worst.
void appendByScore(std::vector<double> scores, std::vector<std::size_t>& order) {
  for (int best = bestCandidate(scores); best >= 0; best = bestCandidate(scores)) {
    const auto i = static_cast<std::size_t>(best);
    order.push_back(i);
    scores[i] = std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

void OperatorPace::check() const {
  requireWithin(0, 10, "operator.speed_m_s", speed_m_s);
  requireWithin(1e-3, 100, "operator.turn_rad_s", turn_rad_s);
  requireWithin(0, 60, "operator.reaction_s", reaction_s);
}

double OperatorPace::secondsTo(const Transform& from, const Transform& to) const {
  const double walk_s = (to.t - from.t).norm() / (isKnown() ? speed_m_s : kUsualSpeed);
  const double turn_s = rotationAngle(to.R * from.R.transpose()) / turn_rad_s;
  // A hand turns while it goes.
  return reaction_s + std::max(walk_s, turn_s);
}

int bestCandidate(const std::vector<double>& scores) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  double most = kNone;
  for (const double score : scores) {
    if (score > most) most = score;  // NaN is not
  }
  if (most == kNone) return -1;
  const double least = std::isfinite(most) ? most - kEqualShare * std::abs(most) : most;
  const auto first =
      std::find_if(scores.begin(), scores.end(), [&](double score) { return score >= least; });
  return static_cast<int>(first - scores.begin());
}

std::vector<std::size_t> byGainPerSecond(const std::vector<double>& gains,
                                         const std::vector<double>& seconds) {
  // Among gains without bound it is the seconds alone that count.
  std::vector<double> unbounded(gains.size(), std::numeric_limits<double>::quiet_NaN());
  std::vector<double> rates = unbounded;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const bool is_unbounded = gains[i] == std::numeric_limits<double>::infinity();
    (is_unbounded ? unbounded : rates)[i] = (is_unbounded ? 1 : gains[i]) / seconds[i];
  }
  std::vector<std::size_t> order;
  appendByScore(std::move(unbounded), order);
  appendByScore(std::move(rates), order);
  return order;
}

}  // namespace plumbline
