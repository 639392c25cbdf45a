// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/april_grid.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/operator/operator_skill.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {

/// A camera (x right, y down, z forward) at p that looks at `aim`, its x axis in the x-z plane of
/// F; poses T_FC0.
Transform lookingAt(const Eigen::Vector3d& p, const Eigen::Vector3d& aim);

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

}  // namespace plumbline
