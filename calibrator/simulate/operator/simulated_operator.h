// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/enum_words.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/random_stream.h"

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

/// The views T_FC0 that a person chooses himself, one after the other (OwnViewsKind).
class OwnViews {
 public:
  /// `distance_m`: at which the board fills the image.
  OwnViews(const OperatorSkill& skill, const AprilGrid& target, double distance_m);

  /// Views around the board draw from `random`.
  Transform next(RandomStream& random);

 private:
  Transform around(RandomStream& random) const;
  Transform danced(int turn) const;

  OperatorSkill skill_;
  Eigen::Vector3d centre_;
  double distance_m_;
  int taken_ = 0;
};

/// A person with a rig in front of a board. Between suggestions, and instead of those that are
/// ignored, own views are gone to (OwnViews). A suggested view is gone to after the reaction time
/// and held: it is passed by a share of the way to it, and met with an error, both corrected as
/// they are seen. A suggested trajectory is begun at its start, held there until the guide says
/// that it was reached, and then followed once. Speeds are limited, the board is kept in view,
/// every hand trembles, and whoever tires is slower and trembles more.
///
/// Motions come as poses T_FC0 at even spacing, for SplineMotion. Equal arguments give equal ones.
class SimulatedOperator {
 public:
  /// `distance_m`: at which the board fills the image.
  SimulatedOperator(const OperatorSkill& skill, const AprilGrid& target, double distance_m,
                    double spacing_s, std::uint64_t seed);

  /// What the guide shows from now on; empty: nothing.
  void show(const std::optional<Suggestion>& suggestion, double t_s);
  /// The start of the trajectory shown was reached, says the guide: it may be followed, within its
  /// duration.
  void go(double t_s);
  /// A trajectory was begun; who shows something else now interrupts it.
  bool isFollowing() const { return following_since_s_.has_value(); }
  /// The trajectory shown was followed to its end by t_s.
  bool hasFollowed(double t_s) const;
  /// From now on the motion is for the IMU: own views are gone through in haste.
  void hurry() { hurries_ = true; }

  /// Has had enough by t_s.
  bool givesUp(double t_s) const { return t_s >= skill_.patience_s; }

  /// The pose one spacing later.
  Transform next();

 private:
  bool attends();
  Transform goal();
  Transform suggestedGoal();
  Transform inView(const Transform& pose) const;
  double tired() const { return 1 + skill_.fatigue_per_min * t_s_ / 60; }
  Transform moved(const Transform& towards);
  Eigen::Vector3d normal(double std) { return std * random_.normalVector(); }

  OperatorSkill skill_;
  Eigen::Vector3d centre_;
  double spacing_s_;
  OwnViews own_views_;
  RandomStream random_;
  double t_s_ = 0;
  bool hurries_ = false;
  Transform pose_, own_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero(), turning_ = Eigen::Vector3d::Zero();
  std::optional<Suggestion> shown_, pursued_;
  double shown_at_s_ = 0, noticed_at_s_ = 0;
  std::optional<double> following_since_s_;
  std::optional<int> ignored_;              // id
  Vector6d error_ = Vector6d::Zero();       // with which the view is met
  Vector6d beyond_ = Vector6d::Zero();      // by which it is passed, ...
  std::optional<double> turned_back_at_s_;  // until then
};

}  // namespace plumbline
