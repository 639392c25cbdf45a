// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "calibrator/base/option_check.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

void OperatorPace::check() const {
  requireWithin(0, 10, "operator.speed_m_s", speed_m_s);
  requireWithin(1e-3, 100, "operator.turn_rad_s", turn_rad_s);
  requireWithin(0, 60, "operator.reaction_s", reaction_s);
}

double OperatorPace::secondsTo(const Transform& from, const Transform& to) const {
  const double walk_s = (to.t - from.t).norm() / speed_m_s;
  const double turn_s = rotationAngle(to.R * from.R.transpose()) / turn_rad_s;
  // A hand turns while it goes.
  return reaction_s + std::max(walk_s, turn_s);
}

std::vector<std::size_t> byGainPerSecond(const std::vector<double>& gains,
                                         const std::vector<double>& seconds) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (!std::isnan(gains[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    // Both without bound: the nearer one.
    if (std::isinf(gains[a]) && std::isinf(gains[b])) return seconds[a] < seconds[b];
    return gains[a] / seconds[a] > gains[b] / seconds[b];
  });
  return order;
}

}  // namespace plumbline
