// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/operator/simulated_operator.h"

#include <algorithm>
#include <cmath>

#include "calibrator/simulate/motion.h"

namespace plumbline {
namespace {

// A dance: to and fro so often along and about each axis, at this multiple of the distance at which
// the board fills the image, so far about x and y (and along z over that distance), and about z.
constexpr int kTimes = 3;
constexpr int kDanceAxes = 6;
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
  const bool dances = skill_.own_views == OwnViewsKind::kDance && turn < 2 * kTimes * kDanceAxes;
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

namespace {

constexpr double kArrived_m = 0.08, kArrived_rad = 0.12;  // an own view is left from here on
constexpr double kTurn_m = 0.01, kTurn_rad = 0.02;        // a view was passed far enough
constexpr double kSmooth_s = 0.25;                        // in which a hand changes its speed
constexpr double kApproach_s = 0.35;                      // in which it slows down before a goal

/// The vector, no longer than `most`.
Eigen::Vector3d limited(const Eigen::Vector3d& v, double most) {
  const double norm = v.norm();
  return norm > most ? Eigen::Vector3d(v * (most / norm)) : v;
}

}  // namespace

SimulatedOperator::SimulatedOperator(const OperatorSkill& skill, const AprilGrid& target,
                                     double distance_m, double spacing_s, std::uint64_t seed)
    : skill_(skill),
      centre_(0.5 * target.width(), 0.5 * target.height(), 0),
      spacing_s_(spacing_s),
      own_views_(skill, target, distance_m),
      random_(seed, RandomPurpose::kTrajectory, {1}) {
  skill_.check();
  pose_ = lookingAt(centre_ + Eigen::Vector3d(0, 0, 1.4 * distance_m), centre_);
  own_ = own_views_.next(random_);
}

void SimulatedOperator::show(const std::optional<Suggestion>& suggestion, double t_s) {
  shown_ = suggestion;
  shown_at_s_ = t_s;
  following_since_s_.reset();
}

void SimulatedOperator::go(double t_s) {
  if (!shown_ || !shown_->duration_s || ignored_ == shown_->id) return;
  following_since_s_ = t_s + skill_.reaction_s;
}

bool SimulatedOperator::hasFollowed(double t_s) const {
  // The hand lags behind its goal by about the time in which it slows down.
  return following_since_s_ && t_s >= *following_since_s_ + *shown_->duration_s + kApproach_s;
}

/// Whether what is shown is noticed and to be followed; decided once.
bool SimulatedOperator::attends() {
  if (!shown_ || t_s_ < shown_at_s_ + skill_.reaction_s || ignored_ == shown_->id) return false;
  if (pursued_ && pursued_->id == shown_->id) return true;
  if (skill_.compliance < 1 && random_.uniform() >= skill_.compliance) {
    ignored_ = shown_->id;
    following_since_s_.reset();
    return false;
  }
  pursued_ = shown_;
  noticed_at_s_ = t_s_;
  // Drawn anew for each suggestion; suggestedGoal() lets both fade.
  error_ << normal(skill_.position_error_m), normal(skill_.angle_error_rad);
  beyond_ = skill_.overshoot * boxminus(shown_->T_FC0, pose_);
  turned_back_at_s_.reset();
  return true;
}

Transform SimulatedOperator::goal() {
  if (attends()) return suggestedGoal();
  pursued_.reset();
  const Vector6d left = boxminus(own_, pose_);
  // Who keeps the board in view may not get nearer to a view than that allows.
  const Vector6d allowed = boxminus(inView(own_), pose_);
  if (std::min(left.head<3>().norm(), allowed.head<3>().norm()) < kArrived_m &&
      std::min(left.tail<3>().norm(), allowed.tail<3>().norm()) < kArrived_rad)
    own_ = own_views_.next(random_);
  return own_;
}

Transform SimulatedOperator::suggestedGoal() {
  // Along the path by the clock, at the guide's pace, errors aside.
  if (following_since_s_ && t_s_ >= *following_since_s_) {
    const double share = std::min(1.0, (t_s_ - *following_since_s_) / *pursued_->duration_s);
    const auto& path = pursued_->path;
    return path[static_cast<std::size_t>(share * static_cast<double>(path.size() - 1))];
  }
  // The error fades from when the view was noticed, the overshoot from when its
  // end was reached.
  const Vector6d error = std::exp(-(t_s_ - noticed_at_s_) / skill_.correction_s) * error_;
  const Transform turn = boxplus(pursued_->T_FC0, Vector6d(error + beyond_));
  const Vector6d left = boxminus(turn, pose_);
  if (!turned_back_at_s_ && left.head<3>().norm() < kTurn_m && left.tail<3>().norm() < kTurn_rad)
    turned_back_at_s_ = t_s_;
  if (!turned_back_at_s_) return turn;
  const double beyond = std::exp(-(t_s_ - *turned_back_at_s_) / skill_.correction_s);
  return boxplus(pursued_->T_FC0, Vector6d(error + beyond * beyond_));
}

/// The pose turned about the camera's position by as little as keeps the board's centre near
/// enough to the axis.
Transform SimulatedOperator::inView(const Transform& pose) const {
  const Eigen::Vector3d z = pose.R.col(2), to = (centre_ - pose.t).normalized();
  const double angle = std::atan2(z.cross(to).norm(), z.dot(to));
  if (!(angle > skill_.off_axis_rad)) return pose;
  const Eigen::Vector3d across = z.cross(to);
  const Eigen::Vector3d axis =
      // With its back to the board any axis across z turns it, such as its own y.
      across.norm() > 1e-9 ? Eigen::Vector3d(across.normalized()) : Eigen::Vector3d(pose.R.col(1));
  return {Eigen::Matrix3d(expSO3((angle - skill_.off_axis_rad) * axis) * pose.R), pose.t};
}

// Speed follows what the distance asks for (all of it within kApproach_s), within its limit, with a
// hand's delay.
Transform SimulatedOperator::moved(const Transform& towards) {
  const Vector6d left = boxminus(inView(towards), pose_);
  // Who follows a trajectory keeps up with it, up to three times as fast as between views.
  const double freely = hurries_ && !pursued_ ? skill_.haste : following_since_s_ ? 3 : 1;
  const double haste = freely / tired();
  // First-order lag over a step of the control poses, whatever their spacing.
  const double smooth = 1 - std::exp(-spacing_s_ / kSmooth_s);
  const Eigen::Vector3d v = limited(left.head<3>() / kApproach_s, haste * skill_.speed_m_s);
  const Eigen::Vector3d w = limited(left.tail<3>() / kApproach_s, haste * skill_.turn_rad_s);
  velocity_ += smooth * (v - velocity_);
  turning_ += smooth * (w - turning_);
  Vector6d step;
  step << velocity_ * spacing_s_, turning_ * spacing_s_;
  return boxplus(pose_, step);
}

Transform SimulatedOperator::next() {
  t_s_ += spacing_s_;
  pose_ = moved(goal());
  Vector6d tremor;
  tremor << normal(tired() * skill_.tremor_m), normal(tired() * skill_.tremor_rad);
  // pose_ stays on its path: tremor does not add up to a drift.
  return boxplus(pose_, tremor);
}

}  // namespace plumbline
