// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/base/transform.h"

namespace plumbline {

/// How fast the operator is taken to move the rig. Where it is known suggestions are chosen by what
/// they gain per second.
struct OperatorPace {
  static constexpr double kUsualSpeed = 0.35;  ///< of the hand, where nothing is known [m/s]
  /// Of the hand [m/s]; 0: not known, the way does not count, and times are those of kUsualSpeed.
  double speed_m_s = 0;
  double turn_rad_s = 0.8;
  double reaction_s = 0.5;  ///< before anything moves [s]

  bool isKnown() const { return speed_m_s > 0; }
  /// reaction + max(distance / speed, angle / turn) [s], straight, while turning.
  double secondsTo(const Transform& from, const Transform& to) const;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Whether `sees` is true of T_FC0 all along the way between two poses as secondsTo() takes it,
/// straight and turning evenly, its ends aside.
template <class Sees>
bool seesAlongWay(const Transform& from, const Transform& to, const Sees& sees) {
  constexpr int kParts = 5;  // at whose ends it is asked
  const Vector6d way = boxminus(to, from);
  for (int k = 1; k < kParts; ++k) {
    if (!sees(boxplus(from, Vector6d(way * k / kParts)))) return false;
  }
  return true;
}

/// Index of the highest score; of scores that are as good as equal, of the first. Those that are
/// not a number do not count; -1 where none is one.
int bestCandidate(const std::vector<double>& scores);

/// The candidates in the order of gain per second, the best first (bestCandidate() of those that
/// are left): gains [nats] over the seconds that each takes. Those whose gain is not a number are
/// left out; of infinite gains the quickest is the first.
std::vector<std::size_t> byGainPerSecond(const std::vector<double>& gains,
                                         const std::vector<double>& seconds);

}  // namespace plumbline
