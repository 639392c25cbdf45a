// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/guide_decision.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// How fast the operator is taken to move the rig. Where it is known suggestions are chosen by what
/// they gain per second.
struct OperatorPace {
  double speed_m_s = 0;  ///< of the hand [m/s]; 0: not known, the way does not count
  double turn_rad_s = 0.8;
  double reaction_s = 0.5;  ///< before anything moves [s]

  bool isKnown() const { return speed_m_s > 0; }
  /// reaction + max(distance / speed, angle / turn) [s], straight, while turning.
  double secondsTo(const Transform& from, const Transform& to) const;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// The candidates in the order of gain per second, the most first: gains [nats] over the seconds
/// that each takes. Those whose gain is not a number are left out; of infinite gains the quickest
/// is the first.
std::vector<std::size_t> byGainPerSecond(const std::vector<double>& gains,
                                         const std::vector<double>& seconds);

}  // namespace plumbline
