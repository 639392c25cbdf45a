// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/window.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "calibrator/base/transform.h"

namespace plumbline {

int Window::indexOf(std::int64_t serial) const {
  const auto at =
      std::lower_bound(frames.begin(), frames.end(), serial,
                       [](const OdometryFrame& f, std::int64_t s) { return f.serial < s; });
  return at != frames.end() && at->serial == serial ? static_cast<int>(at - frames.begin()) : -1;
}

void Window::dropSightings(
    const std::function<bool(const Landmark&, const LandmarkSighting&)>& drop) {
  for (auto& entry : landmarks) {
    Landmark& landmark = entry.second;
    std::erase_if(landmark.sightings, [&](const LandmarkSighting& s) { return drop(landmark, s); });
    if (landmark.sightings.size() < 2) landmark.p_W.reset();
  }
  std::erase_if(landmarks, [](const auto& l) { return l.second.sightings.empty(); });
}

void Window::dropFrame(std::size_t index) {
  const std::int64_t serial = frames[index].serial;
  frames.erase(frames.begin() + index);
  dropSightings([&](const Landmark&, const LandmarkSighting& s) { return s.frame == serial; });
}

Eigen::VectorXd displacements(const Window& window) {
  const WindowPrior& prior = window.prior;
  Eigen::VectorXd d(kState * prior.frames.size());
  for (std::size_t i = 0; i < prior.frames.size(); ++i) {
    d.segment<kState>(kState * i) = boxminus(window.frame(prior.frames[i]).state, prior.points[i]);
  }
  return d;
}

namespace {

/// Whether a pause of more than max_gap_s lies between the samples about [from, to], or they do not
/// reach from one end to the other.
bool hasGap(std::span<const ImuSample> samples, TimeNs from, TimeNs to, double max_gap_s) {
  auto at = std::upper_bound(samples.begin(), samples.end(), from,
                             [](TimeNs t, const ImuSample& s) { return t < s.t; });
  if (at == samples.begin()) return true;
  for (; at != samples.end(); ++at) {
    if (secondsBetween((at - 1)->t, at->t) > max_gap_s) return true;
    if (at->t >= to) return false;
  }
  return true;
}

}  // namespace

std::optional<ImuLink> imuLink(std::span<const ImuSample> samples, const RigModel& rig, TimeNs from,
                               TimeNs to, const ImuBias& bias, double max_gap_s) {
  const TimeNs offset = toNanoseconds(rig.time_offset_s);
  if (hasGap(samples, from + offset, to + offset, max_gap_s)) return std::nullopt;
  const ImuWindow span{from, to, rig.time_offset_s};
  const auto motion = preintegrate(samples, span, bias);
  const auto covariance = preintegrationCovariance(samples, span, bias, rig.noise);
  if (!motion || !covariance) return std::nullopt;
  return ImuLink{from, to, *motion, bias, imuWeight(*covariance, rig.noise, span.duration_s())};
}

Preintegration motionAt(const ImuLink& link, const ImuState& state) {
  // First order in the biases (Forster et al., RSS 2015): no sample is visited again.
  const Eigen::Vector3d d_gyro = state.gyro_bias - link.at.gyro;
  const Eigen::Vector3d d_accel = state.accel_bias - link.at.accel;
  Preintegration m = link.motion;
  m.R = m.R * expSO3(m.R_bg * d_gyro);
  m.v += m.v_bg * d_gyro + m.v_ba * d_accel;
  m.p += m.p_bg * d_gyro + m.p_ba * d_accel;
  return m;
}

ImuState predicted(const ImuState& from, const ImuLink& link, double gravity_m_s2) {
  const Preintegration m = motionAt(link, from);
  const Eigen::Vector3d g(0, 0, -gravity_m_s2);
  const double T = m.duration_s;
  ImuState to = from;
  // Products of many links drift off the rotations by rounding.
  to.T_FS.R = nearestRotation(from.T_FS.R * m.R);
  to.T_FS.t = from.T_FS.t + from.v_F * T + 0.5 * T * T * g + from.T_FS.R * m.p;
  to.v_F = from.v_F + T * g + from.T_FS.R * m.v;
  return to;
}

std::optional<Eigen::Vector2d> sightingError(const Sighting& seen, const RigModel& rig,
                                             const Transform& T_WS, const Eigen::Vector3d& p_W) {
  const Transform& T_SC = rig.T_SC[seen.camera];
  const Eigen::Vector3d p_S = T_WS.R.transpose() * (p_W - T_WS.t);
  const Eigen::Vector3d p_C = T_SC.R.transpose() * (p_S - T_SC.t);
  // [m]: what is nearer along the ray counts as behind.
  if (p_C.dot(seen.f) <= 0.02) return std::nullopt;
  return Eigen::Vector2d(seen.M * p_C / p_C.norm());
}

std::optional<SightingResidual> sightingResidual(const Sighting& seen, const RigModel& rig,
                                                 const Transform& T_WS, const Transform& T_point,
                                                 const Eigen::Vector3d& p_W) {
  const auto e = sightingError(seen, rig, T_WS, p_W);
  if (!e) return std::nullopt;
  const Transform& T_SC = rig.T_SC[seen.camera];
  const Eigen::Vector3d arm = p_W - T_point.t;
  const Eigen::Matrix3d R_CW = (T_point.R * T_SC.R).transpose();
  const Eigen::Vector3d p_C = R_CW * arm - T_SC.R.transpose() * T_SC.t;
  const double range = p_C.norm();
  const Eigen::Vector3d u = p_C / range;
  SightingResidual out;
  out.e = *e;
  // d(p/|p|) = (I - u u')/|p| dp;  p_C = R_CW (p_W - t): dt acts as -dp_W, a turn of the body on
  // the left as arm x.
  const Eigen::Matrix<double, 2, 3> G = (seen.M - (seen.M * u) * u.transpose()) / range;
  out.J_point.noalias() = G * R_CW;
  out.J_pose.leftCols<3>() = -out.J_point;
  out.J_pose.rightCols<3>().noalias() = out.J_point * skew(arm);
  return out;
}

std::optional<Eigen::Vector3d> triangulated(const Window& window, const RigModel& rig,
                                            const std::vector<LandmarkSighting>& sightings,
                                            const TriangulationLimits& limits) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  double least_cosine = 1;
  for (const LandmarkSighting& s : sightings) {
    if (window.indexOf(s.frame) < 0) continue;  // it has left
    const Transform T_WC = window.frame(s.frame).state.T_FS * rig.T_SC[s.seen.camera];
    const Eigen::Vector3d ray = T_WC.R * s.seen.f;
    if (first.isZero()) first = ray;
    // The angle to the first ray stands for those between all pairs.
    least_cosine = std::min(least_cosine, first.dot(ray));
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose();
    // Least sum of squared distances to the rays: sum (I - r r') (p - c) = 0.
    A += across;
    b += across * T_WC.t;
  }
  if (!(least_cosine < std::cos(limits.min_angle_rad))) return std::nullopt;
  // In metres off the rays, not in pixels: a start for the window. The limits below judge it in
  // deviations of its sightings.
  const Eigen::Vector3d p = A.ldlt().solve(b);
  for (const LandmarkSighting& s : sightings) {
    if (window.indexOf(s.frame) < 0) continue;
    const Transform& T_WS = window.frame(s.frame).state.T_FS;
    const auto e = sightingError(s.seen, rig, T_WS, p);
    const double range = (p - T_WS.t).norm();
    if (!e || !(e->norm() < limits.max_error)) return std::nullopt;
    if (!(range > limits.min_depth_m && range < limits.max_depth_m)) return std::nullopt;
  }
  return p;
}

}  // namespace plumbline
