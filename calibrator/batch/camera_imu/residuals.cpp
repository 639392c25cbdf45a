// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "calibrator/base/parallel.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

/// Writes the residuals of one frame, camera by camera, from `out` on.
void frameResiduals(const CameraImuProblem& problem, const CameraImuEstimate& estimate, int frame,
                    CornerResidual* out) {
  const Frame& f = problem.frames[frame];
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    if (f.view[c] < 0) continue;
    const Transform T_CF = targetInCamera(problem, estimate, frame, c);
    const PackedView view = problem.corners[c].view(f.view[c]);
    const auto errors = viewErrors(estimate.cameras[c].intrinsics, T_CF, view);
    for (int k = 0; k < view.count; ++k) {
      const Eigen::Vector2d uv(view.u[k], view.v[k]);
      *out++ = {static_cast<int>(c),     frame,        view.id[k], uv.cast<float>(),
                errors[k].cast<float>(), view.w[k] > 0};
    }
  }
}

/// Readings that the whitened residuals of an interval are about: the mean rate and mean specific
/// force over it, bias included, by the IMU and by the states. Their deviations are the roots of
/// the covariance's diagonal, the norms of the rows of its Cholesky factor.
void addReadings(const Preintegration& motion, const ImuState& i, const ImuState& j,
                 const Gravity& gravity, const Matrix9d& sqrt_information,
                 ImuIntervalResidual& interval) {
  // Biases are added back: what is shown compares with the samples.
  const double T = interval.dt_s;
  const Eigen::Matrix3d R_SF = i.T_FS.R.transpose();
  interval.gyro.measured = logSO3(motion.R) / T + i.gyro_bias;
  interval.gyro.predicted = logSO3(R_SF * j.T_FS.R) / T + i.gyro_bias;
  interval.accel.measured = motion.v / T + i.accel_bias;
  interval.accel.predicted =
      R_SF * ((j.v_F - i.v_F) / T - gravity.magnitude * gravity.direction) + i.accel_bias;
  const Matrix9d factor =  // lower Cholesky factor of the covariance
      sqrt_information.triangularView<Eigen::Lower>().solve(Matrix9d::Identity());
  interval.gyro.std = factor.topRows<3>().rowwise().norm() / T;
  interval.accel.std = factor.middleRows<3>(3).rowwise().norm() / T;
}

}  // namespace

std::vector<CornerResidual> cornerResiduals(const CameraImuProblem& problem,
                                            const CameraImuEstimate& estimate) {
  std::vector<std::size_t> first(1, 0);  // of each frame, in the list
  for (const Frame& frame : problem.frames) {
    first.push_back(first.back() + cornerCount(frame, problem.corners));
  }
  std::vector<CornerResidual> out(first.back());
  // Every frame writes to places of its own in the list.
  parallelCalls(problem.frameCount(), problem.threads,
                [&](int i) { frameResiduals(problem, estimate, i, out.data() + first[i]); });
  return out;
}

std::vector<ImuIntervalResidual> imuIntervalResiduals(const CameraImuProblem& problem,
                                                      const CameraImuEstimate& estimate,
                                                      const ImuWeights& weights) {
  std::vector<ImuIntervalResidual> out;
  const Gravity gravity{estimate.gravity_direction, problem.gravity_m_s2};
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] != FrameLink::kInertial) continue;
    const ImuState& i = estimate.states[k];
    const ImuState& j = estimate.states[k + 1];
    const ImuWindow window{problem.frames[k].t, problem.frames[k + 1].t, estimate.timeOffset()};
    const auto motion = preintegrate(problem.samples, window, {i.gyro_bias, i.accel_bias});
    if (!motion) continue;
    const Vector9d r = imuResidual(*motion, i, j, gravity).r;
    const Vector6d walk = biasWalkResidual(i, j);
    ImuIntervalResidual interval;
    interval.t = window.from;
    interval.dt_s = window.duration_s();
    interval.rotation_rad = r.head<3>();
    interval.velocity_m_s = r.segment<3>(3);
    interval.position_m = r.tail<3>();
    // By the weights of the solution, so that their squares are the cost's.
    interval.normalised << weights[k].sqrt_information * r, walk.cwiseProduct(weights[k].walk());
    addReadings(*motion, i, j, gravity, weights[k].sqrt_information, interval);
    out.push_back(interval);
  }
  return out;
}

ImuResidualSummary summarise(const std::vector<ImuIntervalResidual>& residuals) {
  ImuResidualSummary s;
  if (residuals.empty()) return s;
  double gyro = 0, accel = 0, rotation = 0, motion = 0, gyro_walk = 0, accel_walk = 0;
  for (const ImuIntervalResidual& r : residuals) {
    gyro += r.rotation_rad.squaredNorm() / (r.dt_s * r.dt_s);
    accel += r.velocity_m_s.squaredNorm() / (r.dt_s * r.dt_s);
    rotation += r.normalised.head<3>().squaredNorm();
    motion += r.normalised.segment<6>(3).squaredNorm();
    gyro_walk += r.normalised.segment<3>(9).squaredNorm();
    accel_walk += r.normalised.tail<3>().squaredNorm();
  }
  const auto n = static_cast<double>(residuals.size());
  s.gyro_rms_rad_s = std::sqrt(gyro / n);
  s.accel_rms_m_s2 = std::sqrt(accel / n);
  s.gyro_normalised_rms = std::sqrt(rotation / (3 * n));
  s.accel_normalised_rms = std::sqrt(motion / (6 * n));
  s.gyro_bias_normalised_rms = std::sqrt(gyro_walk / (3 * n));
  s.accel_bias_normalised_rms = std::sqrt(accel_walk / (3 * n));
  s.chi2 = rotation + motion + gyro_walk + accel_walk;
  // Rows, without what states and calibration take of them: the noise check knows that
  // (redundancy).
  s.dof = static_cast<int>(15 * residuals.size());
  return s;
}

FrameErrors frameErrors(const CameraImuProblem& problem, const CameraImuEstimate& estimate) {
  constexpr int kDelay = MovedView::kDelay;
  // Re-weighted, as all else that is said of the optimum.
  const GramOptions gram{problem.gram.cauchy_px, 0};
  FrameErrors out;
  // (free: sum of b' H^-1 b, along: sum of b_d^2 / H_dd.)
  double squares = 0, corners = 0, free = 0, along = 0, weight = 0, products = 0, before = 0;
  for (std::size_t i = 0; i < problem.frames.size(); ++i) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    double H_d = 0, b_d = 0;
    for (std::size_t c = 0; c < problem.corners.size(); ++c) {
      if (problem.frames[i].view[c] < 0) continue;
      const MovedView view = movedView(problem, estimate, gram, {i, c});
      H += view.H.topLeftCorner<6, 6>();
      b += view.b.head<6>();
      H_d += view.H(kDelay, kDelay);
      b_d += view.b(kDelay);
      squares += view.squared_error;
      corners += problem.corners[c].view(problem.frames[i].view[c]).used();
    }
    // Twice what the cost falls by with the pose free, and below with its stamp alone free.
    free += SymmetricFactor(H).squaredNorm(b);
    const double taken = H_d > 0 ? b_d / std::sqrt(H_d) : 0;
    along += taken * taken;
    weight += H_d;
    products += taken * before;
    before = taken;
  }
  const auto n = static_cast<double>(problem.frames.size());
  if (!(corners > 0 && weight > 0 && along > 0)) return out;
  out.rmse_px = std::sqrt(squares / corners);
  out.free_rmse_px = std::sqrt(std::max(0.0, squares - free) / corners);
  out.along = along / n;
  // What noise takes along any one direction.
  out.across = (free - along) / (5 * n);
  out.neighbours = products / along;
  // A shift of d seconds takes H_dd d^2 beyond that.
  out.jitter_s = std::sqrt(std::max(0.0, along - n * out.across) / weight);
  return out;
}

}  // namespace plumbline
