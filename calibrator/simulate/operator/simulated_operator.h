// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {

/// How well a person moves a rig. The defaults are of someone who has done it a few times.
struct OperatorSkill {
  double reaction_s = 0.5;  ///< from what is shown to what is done about it [s]
  double speed_m_s = 0.35;  ///< of the hand between views [m/s]
  double turn_rad_s = 0.8;  ///< likewise [rad/s]
  double position_error_m =
      0.05;  ///< std per axis with which a view that is asked for is met at first
  double angle_error_rad = 0.05;  ///< likewise, per axis
  double correction_s = 1.2;      ///< time constant with which that error is seen and corrected
  double tremor_m = 4e-4;         ///< std of the hand about its path, per axis
  double tremor_rad = 1.5e-3;
  double reach_rad = 0.6;   ///< how far around the board own views go, in azimuth and elevation
  double roll_rad = 0.5;    ///< how far own views are rolled
  double haste = 1.5;       ///< own motions for the IMU are so much faster than those for views
  double patience_s = 600;  ///< gives up then

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A person with a rig in front of a board. Between suggestions views are chosen as people choose
/// them: around the board, near and far, rolled, one after the other. A suggested view is gone to
/// after the reaction time and held, with an error that is corrected as it is seen; a suggested
/// trajectory is begun at its start, held there until the guide says that it was reached, and then
/// followed once. Speeds are limited, and every hand trembles.
///
/// Motions come as poses T_FC0 at even spacing, for SplineMotion. Equal arguments give equal ones.
class SimulatedOperator {
 public:
  /// `distance_m`: at which the board fills the image.
  SimulatedOperator(const OperatorSkill& skill, const AprilGrid& target, double distance_m,
                    double spacing_s, std::uint64_t seed);

  /// What the guide shows from now on; empty: nothing.
  void show(const std::optional<Suggestion>& suggestion, double t_s);
  /// The start of the trajectory shown was reached, says the guide: it may be followed.
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
  Transform ownView();
  Transform goal();
  Transform moved(const Transform& towards);
  Transform trembling(const Transform& pose);
  Eigen::Vector3d normal(double std);

  OperatorSkill skill_;
  Eigen::Vector3d centre_;
  double distance_m_;
  double spacing_s_;
  RandomStream random_;
  double t_s_ = 0;
  bool hurries_ = false;
  Transform pose_, own_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero(), turning_ = Eigen::Vector3d::Zero();
  std::optional<Suggestion> shown_, pursued_;
  double shown_at_s_ = 0, arrived_at_s_ = 0;
  std::optional<double> following_since_s_;
  Vector6d error_ = Vector6d::Zero();
};

/// At which the board's longer side fills the shorter side of the image, at least 0.3 m.
double fillingDistance(const AprilGrid& target, const Intrinsics& camera);

}  // namespace plumbline
