// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/operator/operator_skill.h"

#include <cmath>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

/// Geometric: a step of clumsiness is a factor, and nothing becomes negative.
double between(double skilled, double clumsy, double clumsiness) {
  return skilled * std::pow(clumsy / skilled, clumsiness);
}

}  // namespace

void OperatorSkill::check() const {
  requireWithin(0, 10, "skill.reaction_s", reaction_s);
  requireWithin(1e-3, 10, "skill.speed_m_s", speed_m_s);
  requireWithin(1e-3, kFastestTurn_rad_s, "skill.turn_rad_s", turn_rad_s);
  requireWithin(0, 1, "skill.position_error_m", position_error_m);
  requireWithin(0, 1, "skill.angle_error_rad", angle_error_rad);
  requireWithin(1e-3, 100, "skill.correction_s", correction_s);
  requireWithin(0, 1, "skill.overshoot", overshoot);
  requireWithin(0, 0.1, "skill.tremor_m", tremor_m);
  requireWithin(0, 0.1, "skill.tremor_rad", tremor_rad);
  requireWithin(0, kFarthestReach_rad, "skill.reach_rad", reach_rad);
  requireWithin(0, 3, "skill.roll_rad", roll_rad);
  requireWithin(0.02, std::numbers::pi, "skill.off_axis_rad", off_axis_rad);
  requireWithin(0.1, 10, "skill.haste", haste);
  requireWithin(0, 10, "skill.fatigue_per_min", fatigue_per_min);
  requireWithin(0, 1, "skill.compliance", compliance);
  requireWithin(0, 1e5, "skill.patience_s", patience_s);
}

OperatorSkill handSkill(double c) {
  OperatorSkill skill;
  skill.reaction_s = between(0.3, 0.9, c);
  skill.speed_m_s = between(0.55, 0.25, c);
  skill.turn_rad_s = between(1.2, 0.6, c);
  skill.position_error_m = between(0.02, 0.09, c);
  skill.angle_error_rad = between(0.02, 0.1, c);
  skill.correction_s = between(0.7, 2.2, c);
  skill.tremor_m = between(2e-4, 8e-4, c);
  skill.tremor_rad = between(8e-4, 3e-3, c);
  skill.reach_rad = between(0.75, 0.3, c);
  skill.roll_rad = between(0.7, 0.15, c);
  skill.haste = between(1.9, 1.2, c);
  return skill;
}

OperatorSkill personSkill(double c) {
  OperatorSkill skill = handSkill(c);
  // Linear: no factor leads away from zero, which is what the most skilled ignores of suggestions.
  skill.overshoot = 0.03 + 0.12 * c;
  skill.fatigue_per_min = 0.02 + 0.13 * c;
  skill.off_axis_rad = 0.6 - 0.2 * c;
  skill.compliance = 1 - 0.25 * c;
  return skill;
}

}  // namespace plumbline
