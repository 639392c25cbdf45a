// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/trajectories/lissajous.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace plumbline {
namespace {

constexpr double kPi = std::numbers::pi;
// Sine of 75 degrees off the target's normal, the furthest a curve goes: beyond, tags are too
// foreshortened to be detected, and z = sqrt(R^2 - x^2 - y^2) has no derivative at its rim.
constexpr double kWidest = 0.965925826;
// Extremes are searched for at so many instants; the margin covers what lies between two of them.
constexpr int kLimitSamples = 720;
constexpr double kLimitMargin = 1e-3;

// A scalar that moves, carried through functions with its first two time derivatives.
ScalarMotion operator+(const ScalarMotion& f, const ScalarMotion& g) {
  return {f.x + g.x, f.dx + g.dx, f.ddx + g.ddx};
}
ScalarMotion operator*(double s, const ScalarMotion& f) { return {s * f.x, s * f.dx, s * f.ddx}; }
ScalarMotion operator*(const ScalarMotion& f, const ScalarMotion& g) {
  return {f.x * g.x, f.dx * g.x + f.x * g.dx, f.ddx * g.x + 2 * f.dx * g.dx + f.x * g.ddx};
}

/// A function's value and first two derivatives, as it moves with its argument.
ScalarMotion chain(const ScalarMotion& f, double value, double first, double second) {
  return {value, first * f.dx, first * f.ddx + second * f.dx * f.dx};
}
ScalarMotion sine(const ScalarMotion& f) {
  return chain(f, std::sin(f.x), std::cos(f.x), -std::sin(f.x));
}
ScalarMotion squareRoot(const ScalarMotion& f) {
  const double root = std::sqrt(f.x);
  return chain(f, root, 0.5 / root, -0.25 / (root * f.x));
}
ScalarMotion arcSine(const ScalarMotion& f) {
  const double c2 = 1 - f.x * f.x;
  const double c = std::sqrt(c2);
  return chain(f, std::asin(f.x), 1 / c, f.x / (c2 * c));
}
/// atan2(f, g), which moves by (f' g - f g') / (f^2 + g^2).
ScalarMotion arcTangent(const ScalarMotion& f, const ScalarMotion& g) {
  const ScalarMotion r2 = f * f + g * g;
  const double numerator = f.dx * g.x - f.x * g.dx;
  const double slope = f.ddx * g.x - f.x * g.ddx;
  return {std::atan2(f.x, g.x), numerator / r2.x, (slope - numerator * r2.dx / r2.x) / r2.x};
}

/// sin^2(pi t / 2T) = (1 - cos(pi t / T)) / 2; at rest outside [0, T].
ScalarMotion progress(double t_s, double duration_s) {
  if (t_s < 0) return {0, 0, 0};
  if (t_s > duration_s) return {1, 0, 0};
  const double w = kPi / duration_s;
  return {0.5 * (1 - std::cos(w * t_s)), 0.5 * w * std::sin(w * t_s),
          0.5 * w * w * std::cos(w * t_s)};
}

}  // namespace

// Frequencies, phases and ratios are those of the paper's public code (yac), which has two more
// shapes than the paper. The sine of y is the code's, too, where the paper prints a cosine.
std::vector<LissajousShape> lissajousShapes() {
  return {{"figure 8 horizontal", 1, 2, kPi, 0.3, 0.3},
          {"figure 8 vertical", 2, 1, kPi, 0.3, 0.3},
          {"pan horizontal", 1, 0, 0, 0.95, 0.95},
          {"pan vertical", 0, 1, 0, 0.95, 0.95},
          {"diagonal 0", 1, 1, 0, 0.6, 0.6},
          {"diagonal 1", 1, 1, kPi, 0.6, 0.6}};
}

LissajousShape lissajousFirst() { return lissajousShapes()[4]; }

LissajousTrajectory::LissajousTrajectory(LissajousShape shape, const AprilGrid& target,
                                         const Transform& T_SC0, const LissajousOptions& options)
    : shape_(std::move(shape)),
      centre_(0.5 * target.width(), 0.5 * target.height()),
      // An axis without frequency stands still: what it could reach must not shrink the other.
      A_(shape_.a == 0 ? 0 : options.amplitude * shape_.width_ratio * target.width()),
      B_(shape_.b == 0 ? 0 : options.amplitude * shape_.height_ratio * target.height()),
      R_(options.distance_ratio * std::max(target.width(), target.height())),
      roll_(options.roll_rad),
      duration_s_(options.duration_s) {
  options.check();
  const double reach = std::hypot(A_, B_);
  // Both axes by the same, which keeps the shape.
  const double shrink = reach > kWidest * R_ ? kWidest * R_ / reach : 1;
  A_ *= shrink;
  B_ *= shrink;
  slowDown(T_SC0.inverse(), options);
}

void LissajousTrajectory::slowDown(const Transform& T_C0S, const LissajousOptions& options) {
  Eigen::Array3d most = Eigen::Array3d::Zero();  // speed, rate, acceleration
  for (int k = 0; k <= kLimitSamples; ++k) {
    const MotionState camera = cameraAt(duration_s_ * k / kLimitSamples);
    for (const MotionState& m : {camera, attached(camera, T_C0S)}) {
      most = most.max(Eigen::Array3d(m.v_F.norm(), m.omega_B.norm(), m.a_F.norm()));
    }
  }
  // A motion slowed by s has rates / s and accelerations / s^2: each limit gives its own s.
  const double slower = std::max({most[0] / options.max_speed_m_s, most[1] / options.max_rate_rad_s,
                                  std::sqrt(most[2] / options.max_acceleration_m_s2)});
  if (slower > 1 - kLimitMargin) duration_s_ *= slower * (1 + kLimitMargin);
}

MotionState LissajousTrajectory::cameraAt(double t_s) const {
  const ScalarMotion theta = progress(t_s, duration_s_);
  const ScalarMotion x = A_ * sine(2 * kPi * shape_.a * theta + ScalarMotion{shape_.delta, 0, 0});
  const ScalarMotion y = B_ * sine(2 * kPi * shape_.b * theta);
  // On a sphere about the target's centre, which stays as far away all along.
  const ScalarMotion z = squareRoot(ScalarMotion{R_ * R_, 0, 0} + -1 * (x * x + y * y));
  const ScalarMotion roll = roll_ * sine(2 * kPi * theta);
  // Line of sight facing * Ry(azimuth) * Rx(elevation) * e_z = -(x, y, z) / R; roll leaves it.
  const RotationMotion facing{facingTarget(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  const RotationMotion head = facing *
                              rotationAbout(Eigen::Vector3d::UnitY(), arcTangent(-1 * x, z)) *
                              rotationAbout(Eigen::Vector3d::UnitX(), arcSine(-1 / R_ * y)) *
                              rotationAbout(Eigen::Vector3d::UnitZ(), roll);
  MotionState m;
  m.T_FB = {head.R, Eigen::Vector3d(centre_.x() + x.x, centre_.y() + y.x, z.x)};
  m.v_F = {x.dx, y.dx, z.dx};
  m.a_F = {x.ddx, y.ddx, z.ddx};
  m.omega_B = head.omega;
  m.alpha_B = head.alpha;
  return m;
}

std::vector<Transform> LissajousTrajectory::path(int count) const {
  assert(count >= 2);
  std::vector<Transform> poses;
  for (int k = 0; k < count; ++k) poses.push_back(cameraAt(duration_s_ * k / (count - 1)).T_FB);
  return poses;
}

std::vector<LissajousTrajectory> lissajousTrajectories(const std::vector<LissajousShape>& shapes,
                                                       const AprilGrid& target,
                                                       const Transform& T_SC0,
                                                       const LissajousOptions& options) {
  std::vector<LissajousTrajectory> out;
  for (const LissajousShape& shape : shapes) out.emplace_back(shape, target, T_SC0, options);
  return out;
}

}  // namespace plumbline
