// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/flight_motion.h"

#include <algorithm>
#include <numbers>

#include "calibrator/base/option_check.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {
namespace {

/// Begin of the first rest [s]: the rig stands in the IMU's margin before the first frame, too.
constexpr double kLongAgo_s = -1000;

/// 10 x^3 - 15 x^4 + 6 x^5 from 0 to 1, whose first two derivatives vanish at both ends.
ScalarMotion quinticStep(double x) {
  if (x <= 0) return {0, 0, 0};
  if (x >= 1) return {1, 0, 0};
  const double x2 = x * x, y = 1 - x;
  return {x2 * x * (10 - 15 * x + 6 * x2), 30 * x2 * y * y, 60 * x * y * (1 - 2 * x)};
}

/// Its integral from 0 to x, x in [0, 1].
double quinticStepIntegral(double x) { return x * x * x * x * (2.5 - 3 * x + x * x); }

/// What a rest takes of the warped time: w = 1 within, ramps beside it. x is the integral of w; a
/// whole ramp loses half of its length.
ScalarMotion lostTo(const std::pair<double, double>& rest, double ramp_s, double t_s) {
  const auto [from, to] = rest;
  if (t_s <= from - ramp_s) return {};
  if (t_s < from) {
    const double x = (t_s - from) / ramp_s + 1;
    const ScalarMotion w = quinticStep(x);
    return {ramp_s * quinticStepIntegral(x), w.x, w.dx / ramp_s};
  }
  if (t_s <= to) return {0.5 * ramp_s + t_s - from, 1, 0};
  if (t_s >= to + ramp_s) return {ramp_s + to - from, 0, 0};
  const double x = (t_s - to) / ramp_s;
  const ScalarMotion w = quinticStep(x);
  // Out of the rest w = 1 - step, whose integral is x less that of the step.
  const double lost = 0.5 * ramp_s + to - from + ramp_s * (x - quinticStepIntegral(x));
  return {lost, 1 - w.x, -w.dx / ramp_s};
}

/// Shares of `reach` at `hertz` and above, each +- 10 %. The ratios are no whole numbers, so that
/// the motion does not repeat.
SumOfSinusoids channel(RandomStream& random, double mean, double reach, double hertz) {
  constexpr std::array<double, SumOfSinusoids::kTerms> kShare{0.65, 0.25, 0.1};
  constexpr std::array<double, SumOfSinusoids::kTerms> kHarmonic{1, 2.1, 4.3};
  SumOfSinusoids s;
  s.mean = mean;
  for (int i = 0; i < SumOfSinusoids::kTerms; ++i) {
    s.amplitude[i] = reach * kShare[i] * random.uniform(0.9, 1.1);
    s.omega[i] = 2 * std::numbers::pi * hertz * kHarmonic[i] * random.uniform(0.9, 1.1);
    s.phase[i] = random.uniform(0, 2 * std::numbers::pi);
  }
  return s;
}

/// The middle of part i of n of a span, moved by up to a quarter of the part.
double within(RandomStream& random, double from, double to, int i, int n) {
  const double part = (to - from) / n;
  return from + part * (i + 0.5 + random.uniform(-0.25, 0.25));
}

/// How many of `count` pieces of length_s fit into a span when they are spread by within(), which
/// leaves at least half a part between the begins of neighbours.
int fitting(int count, double span_s, double length_s) {
  return std::clamp(static_cast<int>(0.5 * span_s / length_s), 0, count);
}

/// Camera 0 looks along x of the heading frame H, its y axis down.
Eigen::Matrix3d headingToImu(const SimulatedRig& rig) {
  Eigen::Matrix3d R_HC;
  R_HC << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R_HC * rig.calibration.imu->T_SC0.R.transpose();
}

}  // namespace

void FlightOptions::check() const {
  requireWithin(0.01, 10, "flight.pace", pace);
  requireWithin(0, 1e4, "flight.first_rest_s", first_rest_s);
  requireWithin(0, 1000, "flight.rests", rests);
  requireWithin(0, 1e4, "flight.rest_s", rest_s);
  requireWithin(0.05, 100, "flight.ramp_s", ramp_s);
  requireWithin(0, 1000, "flight.turns", turns);
  requireWithin(0, 10, "flight.turn_rad", turn_rad);
  requireWithin(0.05, 100, "flight.turn_s", turn_s);
  requireWithin(1, 1000, "flight.room_m", room_m.minCoeff());
  requireWithin(1, 1000, "flight.room_m", room_m.maxCoeff());
}

FlightMotion::FlightMotion(const SimulatedRig& rig, double duration_s, const FlightOptions& o)
    : ramp_s_(o.ramp_s), turn_s_(o.turn_s), T_HS_(headingToImu(rig), Eigen::Vector3d::Zero()) {
  RandomStream random(o.seed, RandomPurpose::kFlight);
  const Eigen::Vector3d half = 0.5 * o.room_m;
  const std::array<double, 6> mean{0, 0, half.z(), 0, 0, 0};
  // Channels reach 1.1 times as far at most.
  const std::array<double, 6> reach{
      0.41 * half.x(), 0.41 * half.y(), 0.36 * half.z(), 1.5, 0.25, 0.2};
  constexpr std::array<double, 6> kHertz{0.12, 0.105, 0.18, 0.05, 0.15, 0.17};
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    channels_[c] = channel(random, mean[c], reach[c], kHertz[c] * o.pace);
  }
  if (o.first_rest_s > 0) rests_.emplace_back(kLongAgo_s, o.first_rest_s);
  // A further rest may begin where the rig has come up to speed.
  const double begin = o.first_rest_s + o.ramp_s;
  const int rests = fitting(o.rests, duration_s - begin, o.rest_s + 2 * o.ramp_s);
  for (int i = 0; i < rests; ++i) {
    const double from = within(random, begin, duration_s, i, rests);
    rests_.emplace_back(from, from + o.rest_s);
  }
  // Warped times: a turn may be held up by a rest in its middle, as the rest of the motion is.
  const double first = warp(begin).x, last = warp(duration_s).x - o.turn_s;
  const int turns = fitting(o.turns, last - first, o.turn_s);
  for (int i = 0; i < turns; ++i) {
    const double s = within(random, first, last, i, turns);
    turns_.push_back({s, random.uniform() < 0.5 ? -o.turn_rad : o.turn_rad});
  }
}

/// s(t) and its derivatives. Rests do not overlap, so that its rate stays within 0 and 1.
ScalarMotion FlightMotion::warp(double t_s) const {
  ScalarMotion s{t_s, 1, 0};
  for (const auto& rest : rests_) {
    const ScalarMotion lost = lostTo(rest, ramp_s_, t_s);
    s.x -= lost.x;
    s.dx -= lost.dx;
    s.ddx -= lost.ddx;
  }
  return s;
}

ScalarMotion FlightMotion::yaw(double s) const {
  ScalarMotion m = channels_[3].at(s);
  for (const Turn& turn : turns_) {
    // A turn stays turned: the step holds its angle from its end on.
    const ScalarMotion step = quinticStep((s - turn.s) / turn_s_);
    m.x += turn.angle * step.x;
    m.dx += turn.angle * step.dx / turn_s_;
    m.ddx += turn.angle * step.ddx / (turn_s_ * turn_s_);
  }
  return m;
}

MotionState FlightMotion::at(double t_s) const {
  const ScalarMotion s = warp(t_s);
  const auto inTime = [&](const ScalarMotion& q) {
    return ScalarMotion{q.x, q.dx * s.dx, q.ddx * s.dx * s.dx + q.dx * s.ddx};
  };
  const auto scalar = [&](std::size_t c) { return inTime(channels_[c].at(s.x)); };
  const ScalarMotion x = scalar(0), y = scalar(1), z = scalar(2);
  const RotationMotion head = rotationAbout(Eigen::Vector3d::UnitZ(), inTime(yaw(s.x))) *
                              rotationAbout(Eigen::Vector3d::UnitY(), scalar(4)) *
                              rotationAbout(Eigen::Vector3d::UnitX(), scalar(5));
  const MotionState m{.T_FB = {head.R, Eigen::Vector3d(x.x, y.x, z.x)},
                      .v_F = {x.dx, y.dx, z.dx},
                      .a_F = {x.ddx, y.ddx, z.ddx},
                      .omega_B = head.omega,
                      .alpha_B = head.alpha};
  // H lies in the IMU, not in the camera: its origin is S's, and only the axes differ.
  return attached(m, T_HS_);
}

}  // namespace plumbline
