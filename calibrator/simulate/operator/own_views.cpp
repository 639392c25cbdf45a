// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/motion.h"
#include "calibrator/simulate/operator/simulated_operator.h"

namespace plumbline {
namespace {

// A dance: to and fro so often along and about each axis, at this multiple of the distance at which
// the board fills the image, so far about x and y (and along z over that distance), and about z.
constexpr int kTimes = 3;
constexpr int kAxes = 6;
constexpr double kDanceDistance = 1.25;
constexpr double kSwing_rad = 0.35;
constexpr double kAdvance = 0.3;
constexpr double kRoll_rad = 0.9;

}  // namespace

OwnViews::OwnViews(const OperatorSkill& skill, const AprilGrid& target, double distance_m)
    : skill_(skill),
      centre_(0.5 * target.width(), 0.5 * target.height(), 0),
      distance_m_(distance_m) {}

Transform OwnViews::next(RandomStream& random) {
  const int turn = taken_++;
  const bool dances = skill_.own_views == OwnViewsKind::kDance && turn < 2 * kTimes * kAxes;
  return dances ? danced(turn) : around(random);
}

Transform OwnViews::around(RandomStream& random) const {
  const double azimuth = random.uniform(-1, 1) * skill_.reach_rad;
  const double elevation = random.uniform(-1, 1) * skill_.reach_rad;
  const double distance = random.uniform(0.85, 1.7) * distance_m_;
  const double roll = random.uniform(-1, 1) * skill_.roll_rad;
  // Aims up to three tenths of half the board off its centre, so that it moves across the image.
  const Eigen::Vector3d aside(random.uniform(-0.3, 0.3) * centre_.x(),
                              random.uniform(-0.3, 0.3) * centre_.y(), 0);
  const Eigen::Vector3d direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                  std::cos(azimuth) * std::cos(elevation));
  Transform view = lookingAt(centre_ + distance * direction, centre_ + aside);
  view.R *= expSO3({0, 0, roll});
  return view;
}

/// Pitch, yaw, roll, then along x, y, z; the far end and the near end of each by turns.
Transform OwnViews::danced(int turn) const {
  const int axis = turn / (2 * kTimes);
  const double side = turn % 2 == 0 ? 1 : -1;
  const double distance = kDanceDistance * distance_m_;
  Transform view = lookingAt(centre_ + Eigen::Vector3d(0, 0, distance), centre_);
  if (axis < 3) {
    const double angle = axis == 2 ? kRoll_rad : kSwing_rad;
    // About the camera's axes, where it stands.
    view.R *= expSO3(side * angle * Eigen::Vector3d::Unit(axis));
  } else {
    const double size[] = {centre_.x(), centre_.y(), kAdvance * distance};
    // Along F's axes, which are the camera's up to signs while it faces the board.
    view.t[axis - 3] += side * size[axis - 3];
  }
  return view;
}

}  // namespace plumbline
