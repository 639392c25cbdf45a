// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>

#include "calibrator/base/transform.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {
namespace {

/// A piece of a window between two neighbouring samples (or a window's end): rates w [rad/s] and
/// forces a [m/s^2] at its ends, and their derivatives by t_d, which move only the window's ends.
struct ImuSegment {
  double dt = 0;  ///< [s]
  Eigen::Vector3d w0, a0, w1, a1;
  bool first = false;  ///< starts at the window's start
  bool last = false;   ///< ends at the window's end
  Eigen::Vector3d w_slope, a_slope;
};

/// Index k of the sample interval [t_k, t_k+1] that holds from + t_d; 0 .. size - 2.
std::size_t segmentStart(std::span<const ImuSample> samples, const ImuWindow& window) {
  const TimeNs start = window.from + toNanoseconds(window.time_offset_s);
  const auto after = std::ranges::upper_bound(samples, start, {}, &ImuSample::t);
  auto k = static_cast<std::ptrdiff_t>(after - samples.begin()) - 1;
  k = std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(samples.size()) - 2);
  return static_cast<std::size_t>(k);
}

/// Calls visit(const ImuSegment&) along a window, in time order. False, without a call, where the
/// samples do not cover it. All times are relative to the window's start, so that no precision is
/// lost to the epoch.
template <class Visit>
bool forEachSegment(std::span<const ImuSample> samples, const ImuWindow& window, Visit&& visit) {
  if (samples.size() < 2) return false;
  const auto tau = [&](std::size_t k) {
    return secondsBetween(window.from, samples[k].t) - window.time_offset_s;
  };
  const double duration = window.duration_s();
  if (tau(0) > 0 || tau(samples.size() - 1) < duration) return false;
  std::size_t k = segmentStart(samples, window);
  // segmentStart() rounds t_d to nanoseconds; here times are exact, so that it may be one off, and
  // no piece of zero length comes first.
  while (k > 0 && tau(k) > 0) --k;
  while (k + 2 < samples.size() && tau(k + 1) <= 0) ++k;

  ImuSegment s;
  double t = 0;
  for (s.first = true; !s.last; s.first = false, ++k) {
    const ImuSample& from = samples[k];
    const ImuSample& to = samples[k + 1];
    const double t0 = tau(k);
    const double t1 = tau(k + 1);
    s.last = t1 >= duration;
    const double end = s.last ? duration : t1;
    s.dt = end - t;
    s.w_slope = (to.gyro - from.gyro) / (t1 - t0);
    s.a_slope = (to.accel - from.accel) / (t1 - t0);
    s.w0 = s.first ? Eigen::Vector3d(from.gyro + s.w_slope * (t - t0)) : from.gyro;
    s.a0 = s.first ? Eigen::Vector3d(from.accel + s.a_slope * (t - t0)) : from.accel;
    s.w1 = s.last ? Eigen::Vector3d(from.gyro + s.w_slope * (end - t0)) : to.gyro;
    s.a1 = s.last ? Eigen::Vector3d(from.accel + s.a_slope * (end - t0)) : to.accel;
    visit(s);
    t = end;
  }
  return true;
}

/// What one segment does: the rotation over it, and the rotation vector's derivatives.
struct SegmentRotation {
  Eigen::Matrix3d R;     // Exp(theta), from the end of the segment to its start
  Eigen::Matrix3d J_bg;  // right perturbation of R by the gyro bias
  Eigen::Vector3d J_td;  // and by t_d
};

/// theta = (w0 + w1) dt / 2 + dt^2/12 w0 x w1 (Magnus expansion of a linear rate, second term; its
/// sign is that of R' = R [w]x, body rates). R changes as Exp(theta + d) = R Exp(Jr d).
/// With t_d the window's ends move while the samples stay: the first piece gets shorter, the last
/// one longer (dt_td = -1, +1; 0 for a piece that is both), and the rate at an end that moves
/// follows the slope between its samples.
SegmentRotation rotateSegment(const ImuSegment& s) {
  const double c = s.dt * s.dt / 12;
  const Eigen::Vector3d mean = 0.5 * (s.w0 + s.w1);
  const Eigen::Vector3d theta = mean * s.dt + c * s.w0.cross(s.w1);
  const Eigen::Matrix3d Jr = rightJacobianSO3(theta);
  SegmentRotation r;
  r.R = expSO3(theta);
  // d/db [(w0 - b) x (w1 - b)] = [w1 - w0]x at b = 0.
  r.J_bg = Jr * (c * skew(s.w1 - s.w0) - s.dt * Eigen::Matrix3d::Identity());
  r.J_td.setZero();
  if (s.first || s.last) {
    const double dt_td = (s.last ? 1 : 0) - (s.first ? 1 : 0);
    Eigen::Vector3d theta_td = mean * dt_td + (s.dt * dt_td / 6) * s.w0.cross(s.w1);
    if (s.first) theta_td += 0.5 * s.dt * s.w_slope + c * s.w_slope.cross(s.w1);
    if (s.last) theta_td += 0.5 * s.dt * s.w_slope + c * s.w0.cross(s.w_slope);
    r.J_td = Jr * theta_td;
  }
  return r;
}

/// Adds the derivatives by t_d of one segment; `o` still holds the state before it, R1 and R_td1
/// belong to its end.
void advanceOffsetDerivative(const ImuSegment& s, const Eigen::Matrix3d& R1,
                             const Eigen::Vector3d& R_td1, Preintegration& o) {
  const double dt = s.dt;
  const double dt_td = (s.last ? 1 : 0) - (s.first ? 1 : 0);
  const Eigen::Vector3d b0 = o.R * s.a0;
  const Eigen::Vector3d b1 = R1 * s.a1;
  Eigen::Vector3d a0_td = o.R_td.cross(s.a0);
  Eigen::Vector3d a1_td = R_td1.cross(s.a1);
  if (s.first) a0_td += s.a_slope;
  if (s.last) a1_td += s.a_slope;
  const Eigen::Vector3d b0_td = o.R * a0_td;
  const Eigen::Vector3d b1_td = R1 * a1_td;
  o.p_td += o.v_td * dt + o.v * dt_td + (2 * dt * dt_td) * (b0 / 3 + b1 / 6) +
            (dt * dt) * (b0_td / 3 + b1_td / 6);
  o.v_td += (0.5 * dt_td) * (b0 + b1) + (0.5 * dt) * (b0_td + b1_td);
}

/// Adds one segment (bias already taken off its samples) to the integrals and their derivatives.
/// The rotated force is linear from b0 = R a0 to b1 = R1 a1:
///   v += dt (b0 + b1) / 2,   p += v dt + dt^2 (b0 / 3 + b1 / 6),
/// p before v, for it takes the velocity at the segment's start; derivatives likewise.
void advance(const ImuSegment& s, Preintegration& o) {
  const double dt = s.dt;
  const SegmentRotation step = rotateSegment(s);
  const Eigen::Matrix3d R1 = o.R * step.R;
  // R Exp(R_bg d) dR Exp(J d) = R dR Exp((dR' R_bg + J) d) to first order.
  const Eigen::Matrix3d R_bg1 = step.R.transpose() * o.R_bg + step.J_bg;
  const Eigen::Vector3d R_td1 = step.R.transpose() * o.R_td + step.J_td;
  advanceOffsetDerivative(s, R1, R_td1, o);

  const Eigen::Matrix3d X0 = o.R * (skew(s.a0) * o.R_bg);  // -d(R a0)/dbg
  const Eigen::Matrix3d X1 = R1 * (skew(s.a1) * R_bg1);
  o.p_bg += o.v_bg * dt - (dt * dt) * (X0 / 3 + X1 / 6);
  o.v_bg -= (0.5 * dt) * (X0 + X1);
  o.p_ba += o.v_ba * dt - (dt * dt) * (o.R / 3 + R1 / 6);
  o.v_ba -= (0.5 * dt) * (o.R + R1);

  const Eigen::Vector3d b0 = o.R * s.a0;
  const Eigen::Vector3d b1 = R1 * s.a1;
  o.p += o.v * dt + (dt * dt) * (b0 / 3 + b1 / 6);
  o.v += (0.5 * dt) * (b0 + b1);
  o.R = R1;
  o.R_bg = R_bg1;
  o.R_td = R_td1;
}

// Slopes stay, for the bias is constant over a window.
ImuSegment withoutBias(const ImuSegment& s, const ImuBias& bias) {
  ImuSegment out = s;
  out.w0 -= bias.gyro;
  out.w1 -= bias.gyro;
  out.a0 -= bias.accel;
  out.a1 -= bias.accel;
  return out;
}

/// P <- F P F^T + Q over one segment that starts at attitude R (in S_i). With A = -R [a]x the
/// attitude error enters velocity as A dt and position as A dt^2/2; noise of the segment's rate,
/// which builds up along it, enters with half of the first and a third of the second, and white
/// force noise has the position variance q dt^3/3.
/// By blocks of 3: F = (dR' 0 0 | A dt, I, 0 | A dt^2/2, I dt, I).
/// What the segment's own rate noise does to velocity and position is of rank 3 here (G G', so
/// dt^3 / 4 where white noise has dt^3 / 3): a difference of third order in the sample interval.
void advanceCovariance(const ImuSegment& s, const Eigen::Matrix3d& R, const Eigen::Matrix3d& dR,
                       const ImuNoise& noise, Matrix9d& P) {
  const double dt = s.dt;
  const Eigen::Matrix3d A = -R * skew(0.5 * (s.a0 + s.a1));
  const auto timesF = [&](const Matrix9d& X) {  // X F'
    Matrix9d Y;
    const Eigen::Matrix<double, 9, 3> lever = X.leftCols<3>().lazyProduct(A.transpose());
    Y.leftCols<3>() = X.leftCols<3>().lazyProduct(dR);
    Y.middleCols<3>(3) = X.middleCols<3>(3) + dt * lever;
    Y.rightCols<3>() = X.rightCols<3>() + dt * X.middleCols<3>(3) + (0.5 * dt * dt) * lever;
    return Y;
  };
  P = timesF(timesF(P).transpose());  // P is symmetric

  const double gyro = noise.gyro_density * noise.gyro_density * dt;
  const double accel = noise.accel_density * noise.accel_density * dt;
  Eigen::Matrix<double, 9, 3> G;  // of the rates' noise
  G << Eigen::Matrix3d::Identity(), A * (dt / 2), A * (dt * dt / 6);
  P += gyro * G.lazyProduct(G.transpose());
  P.diagonal().segment<3>(3).array() += accel;
  P.block<3, 3>(3, 6).diagonal().array() += accel * dt / 2;
  P.block<3, 3>(6, 3).diagonal().array() += accel * dt / 2;
  P.diagonal().tail<3>().array() += accel * dt * dt / 3;
}

/// Mean of the samples within +- half_width_s of an instant of the IMU's clock, bias taken off;
/// where there is none, the next sample after it, or the last of all.
ImuBias meanAround(std::span<const ImuSample> samples, TimeNs centre, double half_width_s,
                   const ImuBias& bias) {
  const TimeNs reach = toNanoseconds(half_width_s);
  auto first = std::ranges::lower_bound(samples, centre - reach, {}, &ImuSample::t);
  auto last = std::ranges::lower_bound(first, samples.end(), centre + reach + 1, {}, &ImuSample::t);
  if (first == last) {
    if (first == samples.end()) --first;
    last = first + 1;
  }
  ImuBias mean;
  for (auto s = first; s != last; ++s) {
    mean.gyro += s->gyro;
    mean.accel += s->accel;
  }
  const auto n = static_cast<double>(last - first);
  return {mean.gyro / n - bias.gyro, mean.accel / n - bias.accel};
}

}  // namespace

Vector9d smoothOffsetDerivative(std::span<const ImuSample> samples, const ImuWindow& window,
                                const ImuBias& bias, const Preintegration& motion) {
  const TimeNs offset = toNanoseconds(window.time_offset_s);
  const double half_width = 0.25 * motion.duration_s;
  const ImuBias i = meanAround(samples, window.from + offset, half_width, bias);
  const ImuBias j = meanAround(samples, window.to + offset, half_width, bias);
  Vector9d d;
  d << j.gyro - motion.R.transpose() * i.gyro,
      motion.R * j.accel - i.accel - i.gyro.cross(motion.v),
      motion.v - i.accel * motion.duration_s - i.gyro.cross(motion.p);
  return d;
}

Preintegration withSmoothOffset(std::span<const ImuSample> samples, const ImuWindow& window,
                                const ImuBias& bias, Preintegration motion) {
  const Vector9d d = smoothOffsetDerivative(samples, window, bias, motion);
  motion.R_td = d.head<3>();
  motion.v_td = d.segment<3>(3);
  motion.p_td = d.tail<3>();
  return motion;
}

std::optional<Preintegration> preintegrate(std::span<const ImuSample> samples,
                                           const ImuWindow& window, const ImuBias& bias) {
  Preintegration o;
  o.duration_s = window.duration_s();
  const bool covered = forEachSegment(
      samples, window, [&](const ImuSegment& s) { advance(withoutBias(s, bias), o); });
  if (!covered) return std::nullopt;
  return o;
}

std::optional<Matrix9d> preintegrationCovariance(std::span<const ImuSample> samples,
                                                 const ImuWindow& window, const ImuBias& bias,
                                                 const ImuNoise& noise) {
  Matrix9d P = Matrix9d::Zero();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const bool covered = forEachSegment(samples, window, [&](const ImuSegment& raw) {
    const ImuSegment s = withoutBias(raw, bias);
    const Eigen::Matrix3d dR = rotateSegment(s).R;
    advanceCovariance(s, R, dR, noise, P);
    R = R * dR;
  });
  if (!covered) return std::nullopt;
  return Matrix9d(0.5 * (P + P.transpose()));
}

}  // namespace plumbline
