// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/odometry/room_flight.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "calibrator/base/image.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {
namespace {

constexpr TimeNs kStart = 1'500'000'000'000'000'000;
constexpr double kMargin = 0.5;

Eigen::Vector3d normalVector(RandomStream& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

std::vector<Eigen::Vector3d> pointsOnWalls(int count, std::uint64_t seed) {
  RandomStream random(seed, RandomPurpose::kOutliers, {7});
  const Eigen::Vector3d half(4, 3, 1.5);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const double wall = random.uniform();
    const int axis = wall < 0.4 ? 0 : wall < 0.8 ? 1 : 2;
    p[axis] = p[axis] < 0 ? -1 : 1;
    points.push_back(p.cwiseProduct(half) + Eigen::Vector3d(0, 0, 1.5));
  }
  return points;
}

/// Camera 0 looks along +x of the body's heading frame: R of S with respect to it.
Eigen::Matrix3d headingToImu(const SimulatedRig& rig) {
  Eigen::Matrix3d R_HC;  // camera x right = -y, y down = -z, z forward = x
  R_HC << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R_HC * rig.calibration.imu->T_SC0.R.transpose();
}

}  // namespace

RoomFlight::RoomFlight(const SimulatedRig& rig, const RoomFlightOptions& options)
    : options_(options) {
  RandomStream random(options.seed, RandomPurpose::kTrajectory, {11});
  const double means[] = {0, 0, 1.5, 0, 0, 0};
  const double reach[] = {1.6, 1.2, 0.5, 1.5, 0.25, 0.2};
  const double hertz[] = {0.08, 0.07, 0.12, 0.05, 0.15, 0.17};
  for (int c = 0; c < 6; ++c) {
    SumOfSinusoids s;
    s.mean = means[c];
    const double share[] = {0.65, 0.25, 0.1}, harmonic[] = {1, 2.1, 4.3};
    for (int i = 0; i < SumOfSinusoids::kTerms; ++i) {
      s.amplitude[i] = reach[c] * share[i] * random.uniform(0.9, 1.1);
      s.omega[i] =
          2 * std::numbers::pi * hertz[c] * harmonic[i] * options.pace * random.uniform(0.9, 1.1);
      s.phase[i] = random.uniform(0, 2 * std::numbers::pi);
    }
    channels_.push_back(s);
  }
  makeImu(rig);
  makeFrames(rig);
}

// Time stands still during the rest and then picks up smoothly within a second.
ScalarMotion RoomFlight::warped(const SumOfSinusoids& channel, double t_s) const {
  constexpr double kRamp = 1;
  const double x = (t_s - options_.rest_s) / kRamp;
  double s = t_s - options_.rest_s - kRamp / 2, ds = 1, dds = 0;
  if (options_.rest_s > 0 && x < 0) {
    s = 0, ds = 0;
  } else if (options_.rest_s > 0 && x < 1) {
    s = kRamp * (x * x * x - x * x * x * x / 2);
    ds = 3 * x * x - 2 * x * x * x;
    dds = (6 * x - 6 * x * x) / kRamp;
  } else if (options_.rest_s <= 0) {
    s = t_s;
  }
  const ScalarMotion m = channel.at(s);
  return {m.x, m.dx * ds, m.ddx * ds * ds + m.dx * dds};
}

MotionState RoomFlight::at(double t_s) const {
  const auto scalar = [&](int c) { return warped(channels_[static_cast<std::size_t>(c)], t_s); };
  const ScalarMotion x = scalar(0), y = scalar(1), z = scalar(2);
  const RotationMotion head = rotationAbout(Eigen::Vector3d::UnitZ(), scalar(3)) *
                              rotationAbout(Eigen::Vector3d::UnitY(), scalar(4)) *
                              rotationAbout(Eigen::Vector3d::UnitX(), scalar(5));
  MotionState m;
  m.T_FB = {head.R, Eigen::Vector3d(x.x, y.x, z.x)};
  m.v_F = {x.dx, y.dx, z.dx};
  m.a_F = {x.ddx, y.ddx, z.ddx};
  m.omega_B = head.omega;
  m.alpha_B = head.alpha;
  return m;
}

void RoomFlight::makeImu(const SimulatedRig& rig) {
  const ImuCalibration& imu = *rig.calibration.imu;
  const Transform T_HS(headingToImu(rig), Eigen::Vector3d::Zero());
  RandomStream random(options_.seed, RandomPurpose::kGyroNoise, {11});
  const double rate = imu.noise.rate_hz, root = std::sqrt(rate);
  const double on = options_.imu_noise ? 1 : 0;
  bias = {0.01 * on * normalVector(random), 0.05 * on * normalVector(random)};
  ImuBias now = bias;
  const auto count = static_cast<int>((options_.duration_s + 2 * kMargin) * rate);
  for (int i = 0; i < count; ++i) {
    const double t = i / rate - kMargin;
    const MotionState m = attached(at(t), T_HS);
    ImuSample sample;
    sample.t = kStart + toNanoseconds(t);
    now.gyro += on * imu.noise.gyro_random_walk / root * normalVector(random);
    now.accel += on * imu.noise.accel_random_walk / root * normalVector(random);
    const Eigen::Vector3d up(0, 0, imu.gravity_m_s2);
    sample.gyro = m.omega_B + now.gyro + on * imu.noise.gyro_density * root * normalVector(random);
    sample.accel = m.T_FB.R.transpose() * (m.a_F + up) + now.accel +
                   on * imu.noise.accel_density * root * normalVector(random);
    samples.push_back(sample);
  }
}

// Tracks live as long as camera 0 sees their point; lost ones are replaced by what is in view.
void RoomFlight::makeFrames(const SimulatedRig& rig) {
  const std::vector<Eigen::Vector3d> points = pointsOnWalls(options_.landmarks, options_.seed);
  const Transform T_HS(headingToImu(rig), Eigen::Vector3d::Zero());
  const ImuCalibration& imu = *rig.calibration.imu;
  RandomStream random(options_.seed, RandomPurpose::kCornerNoise, {11});
  std::map<std::size_t, std::int64_t> tracked;  // point -> id
  std::int64_t next = 0;
  const auto count = static_cast<int>(options_.duration_s * rig.camera_rate_hz);
  for (int k = 0; k < count; ++k) {
    const double t_imu = k / rig.camera_rate_hz;
    FrameTracks frame;
    frame.t = kStart + toNanoseconds(t_imu - imu.timeOffset());
    const MotionState m = attached(at(t_imu), T_HS);
    std::map<std::size_t, std::int64_t> seen;
    const auto view = [&](std::size_t camera, std::size_t point) {
      const CameraCalibration& c = rig.calibration.cameras[camera];
      const Transform T_WC = m.T_FB * imu.T_SC0 * c.T_C0Ci;
      const Eigen::Vector3d p_C = T_WC.inverse() * points[point];
      auto uv = p_C.z() > 0.2 ? project(c.intrinsics, p_C) : std::nullopt;
      if (uv && !isInImage(*uv, c.intrinsics.resolution)) uv.reset();
      return uv;
    };
    const auto take = [&](std::size_t point, std::int64_t id) {
      seen[point] = id;
      for (std::size_t c = 0; c < rig.calibration.cameras.size(); ++c) {
        auto uv = view(c, point);
        if (!uv) continue;
        *uv += options_.pixel_sigma * Eigen::Vector2d(random.normal(), random.normal());
        if (random.uniform() < options_.outlier_share) {
          *uv = {random.uniform(0, 700), random.uniform(0, 450)};
        }
        frame.points.push_back({id, static_cast<int>(c), *uv});
      }
    };
    for (const auto& [point, id] : tracked) {
      if (view(0, point)) take(point, id);
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (static_cast<int>(seen.size()) >= options_.tracks) break;
      if (seen.count(p) == 0 && view(0, p)) take(p, next++);
    }
    tracked = std::move(seen);
    truth.push_back(m);
    frames.push_back(std::move(frame));
  }
}

double RoomFlight::length() const {
  double sum = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    sum += (truth[i].T_FB.t - truth[i - 1].T_FB.t).norm();
  }
  return sum;
}

double alignedRmse(const std::vector<Eigen::Vector3d>& estimate,
                   const std::vector<Eigen::Vector3d>& truth) {
  Eigen::Matrix3Xd from(3, estimate.size()), to(3, truth.size());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = estimate[i];
    to.col(static_cast<Eigen::Index>(i)) = truth[i];
  }
  const Eigen::Matrix4d T = Eigen::umeyama(from, to, false);
  const Eigen::Matrix3Xd d =
      (T.topLeftCorner<3, 3>() * from).colwise() + Eigen::Vector3d(T.topRightCorner<3, 1>()) - to;
  return std::sqrt(d.colwise().squaredNorm().mean());
}

}  // namespace plumbline
