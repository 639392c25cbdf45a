// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/operator/simulated_operator.h"

#include <algorithm>
#include <cmath>

#include "calibrator/base/calibration.h"
#include "calibrator/base/lie.h"
#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

constexpr double kArrived_m = 0.08, kArrived_rad = 0.12;  // an own view is left from here on
constexpr double kSmooth_s = 0.25;                        // in which a hand changes its speed
constexpr double kApproach_s = 0.35;                      // in which it slows down before a goal
constexpr double kPathDuration_s = 5;  // of a suggested trajectory, as the guide shows it

/// A camera (x right, y down, z forward) at p that looks at `aim`, its x axis in the x-z plane of
/// F.
Transform lookingAt(const Eigen::Vector3d& p, const Eigen::Vector3d& aim) {
  const Eigen::Vector3d z = (aim - p).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(-z.z(), 0, z.x()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {R, p};
}

Eigen::Vector3d limited(const Eigen::Vector3d& v, double most) {
  const double norm = v.norm();
  return norm > most ? Eigen::Vector3d(v * (most / norm)) : v;
}

}  // namespace

void OperatorSkill::check() const {
  requireWithin(0, 10, "skill.reaction_s", reaction_s);
  requireWithin(1e-3, 10, "skill.speed_m_s", speed_m_s);
  requireWithin(1e-3, 10, "skill.turn_rad_s", turn_rad_s);
  requireWithin(0, 1, "skill.position_error_m", position_error_m);
  requireWithin(0, 1, "skill.angle_error_rad", angle_error_rad);
  requireWithin(1e-3, 100, "skill.correction_s", correction_s);
  requireWithin(0, 0.1, "skill.tremor_m", tremor_m);
  requireWithin(0, 0.1, "skill.tremor_rad", tremor_rad);
  requireWithin(0, 1.2, "skill.reach_rad", reach_rad);
  requireWithin(0, 3, "skill.roll_rad", roll_rad);
  requireWithin(0.1, 10, "skill.haste", haste);
  requireWithin(0, 1e5, "skill.patience_s", patience_s);
}

double fillingDistance(const AprilGrid& target, const Intrinsics& camera) {
  const int side = std::min(camera.resolution.width, camera.resolution.height);
  const double focal = camera.projection[camera.projection.size() - 4];
  return std::max(0.3, std::max(target.width(), target.height()) * focal / side);
}

SimulatedOperator::SimulatedOperator(const OperatorSkill& skill, const AprilGrid& target,
                                     double distance_m, double spacing_s, std::uint64_t seed)
    : skill_(skill),
      centre_(0.5 * target.width(), 0.5 * target.height(), 0),
      distance_m_(distance_m),
      spacing_s_(spacing_s),
      random_(seed, RandomPurpose::kTrajectory, {1}) {
  skill_.check();
  pose_ = lookingAt(centre_ + Eigen::Vector3d(0, 0, 1.4 * distance_m_), centre_);
  own_ = ownView();
}

void SimulatedOperator::show(const std::optional<Suggestion>& suggestion, double t_s) {
  shown_ = suggestion;
  shown_at_s_ = t_s;
  following_since_s_.reset();
}

void SimulatedOperator::go(double t_s) {
  if (shown_ && !shown_->path.empty()) following_since_s_ = t_s + skill_.reaction_s;
}

bool SimulatedOperator::hasFollowed(double t_s) const {
  return following_since_s_ && t_s >= *following_since_s_ + kPathDuration_s + kApproach_s;
}

Eigen::Vector3d SimulatedOperator::normal(double std) {
  const double x = random_.normal(), y = random_.normal(), z = random_.normal();
  return std * Eigen::Vector3d(x, y, z);
}

Transform SimulatedOperator::ownView() {
  const double azimuth = random_.uniform(-1, 1) * skill_.reach_rad;
  const double elevation = random_.uniform(-1, 1) * skill_.reach_rad;
  const double distance = random_.uniform(0.85, 1.7) * distance_m_;
  const double roll = random_.uniform(-1, 1) * skill_.roll_rad;
  const Eigen::Vector3d aside(random_.uniform(-0.3, 0.3) * centre_.x(),
                              random_.uniform(-0.3, 0.3) * centre_.y(), 0);
  const Eigen::Vector3d direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                  std::cos(azimuth) * std::cos(elevation));
  Transform view = lookingAt(centre_ + distance * direction, centre_ + aside);
  view.R *= expSO3({0, 0, roll});
  return view;
}

Transform SimulatedOperator::goal() {
  const bool seen = shown_ && t_s_ >= shown_at_s_ + skill_.reaction_s;
  if (!seen) {
    pursued_.reset();
    const Vector6d left = boxminus(own_, pose_);
    if (left.head<3>().norm() < kArrived_m && left.tail<3>().norm() < kArrived_rad)
      own_ = ownView();
    return own_;
  }
  if (!pursued_ || pursued_->id != shown_->id) {
    pursued_ = shown_;
    arrived_at_s_ = t_s_;
    error_ << normal(skill_.position_error_m), normal(skill_.angle_error_rad);
  }
  if (following_since_s_ && t_s_ >= *following_since_s_) {
    const double share = std::min(1.0, (t_s_ - *following_since_s_) / kPathDuration_s);
    const auto& path = pursued_->path;
    return path[static_cast<std::size_t>(share * static_cast<double>(path.size() - 1))];
  }
  const double left = std::exp(-(t_s_ - arrived_at_s_) / skill_.correction_s);
  return boxplus(pursued_->T_FC0, Vector6d(left * error_));
}

// Speed follows what the distance asks for, within its limit, with a hand's delay.
Transform SimulatedOperator::moved(const Transform& towards) {
  const Vector6d left = boxminus(towards, pose_);
  const double haste = hurries_ && !pursued_ ? skill_.haste : following_since_s_ ? 3 : 1;
  const double smooth = 1 - std::exp(-spacing_s_ / kSmooth_s);
  const Eigen::Vector3d v = limited(left.head<3>() / kApproach_s, haste * skill_.speed_m_s);
  const Eigen::Vector3d w = limited(left.tail<3>() / kApproach_s, haste * skill_.turn_rad_s);
  velocity_ += smooth * (v - velocity_);
  turning_ += smooth * (w - turning_);
  Vector6d step;
  step << velocity_ * spacing_s_, turning_ * spacing_s_;
  return boxplus(pose_, step);
}

Transform SimulatedOperator::trembling(const Transform& pose) {
  Vector6d tremor;
  tremor << normal(skill_.tremor_m), normal(skill_.tremor_rad);
  return boxplus(pose, tremor);
}

Transform SimulatedOperator::next() {
  t_s_ += spacing_s_;
  pose_ = moved(goal());
  return trembling(pose_);
}

}  // namespace plumbline
