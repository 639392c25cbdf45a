// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <numbers>

#include "calibrator/base/enum_words.h"

namespace plumbline {

/// Which views a person takes between suggestions, or without a guide.
enum class OwnViewsKind {
  kAround,  ///< around the board, near and far, rolled, one after the other
  /// As Kalibr's manual has it: in front of the board three times to and fro about each axis of
  /// the camera and three times along each, then views around the board.
  kDance,
};
constexpr std::array<const char*, 2> enumWords(OwnViewsKind /*of*/) { return {"around", "dance"}; }

/// How well a person moves a rig. The defaults are of someone who has done it a few times, does all
/// that is asked for and does not tire.
struct OperatorSkill {
  static constexpr double kFastestTurn_rad_s = 10, kFarthestReach_rad = 1.2;

  double reaction_s = 0.5;  ///< from what is shown to what is done about it [s]
  double speed_m_s = 0.35;  ///< of the hand between views [m/s]
  double turn_rad_s = 0.8;  ///< likewise [rad/s]
  double position_error_m =
      0.05;  ///< std per axis with which a view that is asked for is met at first
  double angle_error_rad = 0.05;  ///< likewise, per axis
  double correction_s = 1.2;      ///< time constant with which errors are seen and corrected
  double overshoot = 0;           ///< share of the way to a suggested view by which it is passed
  double tremor_m = 4e-4;         ///< std of the hand about its path, per axis
  double tremor_rad = 1.5e-3;
  double reach_rad = 0.6;  ///< how far around the board own views go, in azimuth and elevation
  double roll_rad = 0.5;   ///< how far own views are rolled
  /// The board's centre is kept within this angle of camera 0's axis, whatever is asked for.
  double off_axis_rad = std::numbers::pi;
  double haste = 1.5;          ///< own motions for the IMU are so much faster than for views
  double fatigue_per_min = 0;  ///< speeds are divided, tremor multiplied by 1 + this t / 60 s
  double compliance = 1;       ///< probability that a suggestion is followed at all
  double patience_s = 600;     ///< gives up then
  OwnViewsKind own_views = OwnViewsKind::kAround;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// The hand of a person between the most skilled (clumsiness 0) and the least (1): times, speeds,
/// errors, tremor and reach go from one's to the other's geometrically.
OperatorSkill handSkill(double clumsiness);

/// The same with habits: overshoot, fatigue, a limited view and suggestions ignored grow with
/// clumsiness, linearly; the most skilled has hardly any.
OperatorSkill personSkill(double clumsiness);

/// Figures of a skill, for documents.
template <class V>
void fields(V& v, OperatorSkill& s) {
  v("reaction_s", s.reaction_s, "s", "from a suggestion to the motion that follows it");
  v("speed_m_s", s.speed_m_s, "m/s", "of the hand between views");
  v("turn_rad_s", s.turn_rad_s, "rad/s", "likewise");
  v("position_error_m", s.position_error_m, "m", "std of the initial error at a view");
  v("angle_error_rad", s.angle_error_rad, "rad", "likewise");
  v("correction_s", s.correction_s, "s", "time constant with which errors are corrected");
  v("overshoot", s.overshoot, "1", "overshoot of a suggested view over the length of the path");
  v("tremor_m", s.tremor_m, "m", "std of the hand around its path");
  v("tremor_rad", s.tremor_rad, "rad", "likewise");
  v("reach_rad", s.reach_rad, "rad", "how far around the board own views go");
  v("roll_rad", s.roll_rad, "rad", "how far own views are rolled");
  v("off_axis_rad", s.off_axis_rad, "rad",
    "largest angle between the board's centre and camera 0's axis");
  v("haste", s.haste, "1", "own motions for the IMU over those for views");
  v("fatigue_per_min", s.fatigue_per_min, "1/min", "growth of tremor, and of slowness");
  v("compliance", s.compliance, "1", "probability that a suggestion is followed");
  v("patience_s", s.patience_s, "s", "time after which the operator gives up");
  v("own_views", s.own_views, "views taken between suggestions, or without a guide");
}

}  // namespace plumbline
