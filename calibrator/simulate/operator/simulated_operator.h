// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/operator/operator_skill.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {

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
