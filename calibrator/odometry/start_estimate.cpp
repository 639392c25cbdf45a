// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/start_estimate.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {

void StartOptions::check() const {
  requirePositive("gyro_bias_sigma", gyro_bias_sigma);
  requirePositive("accel_bias_sigma", accel_bias_sigma);
  requirePositive("gravity_sigma", gravity_sigma);
  requireOption(min_landmarks >= 4, "min_landmarks", min_landmarks, "4 or more");
  requirePositive("velocity_sigma", velocity_sigma.value_or(1));
  requirePositive("max_rms", max_rms);
  requirePositive("max_velocity_std", max_velocity_std);
  requirePositive("max_tilt_std", max_tilt_std);
}

namespace {

constexpr int kGlobals = 12;  // v_0, g, gyro bias, accelerometer bias
using GlobalVector = Eigen::Matrix<double, kGlobals, 1>;
using GlobalMatrix = Eigen::Matrix<double, kGlobals, kGlobals>;
constexpr int kStartIterations = 10;

struct Globals {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  ImuBias bias;
};

struct SeenPoint {
  std::vector<std::pair<std::size_t, Sighting>> sightings;  // frame
  std::optional<Eigen::Vector3d> p;                         // in S_0
};

struct Row {
  Eigen::Vector2d e;
  Eigen::Matrix<double, 2, 3> J_point;
  Eigen::Matrix<double, 2, kGlobals> J;
};

/// Gauss-Newton on the 12 global unknowns, landmarks eliminated as they are visited, so that the
/// time is linear in the sightings. The IMU is integrated anew at every step, from the first frame
/// to each: the biases have moved.
class StartProblem {
 public:
  StartProblem(std::span<const StartFrame> frames, std::span<const ImuSample> samples,
               const RigModel& rig, const StartOptions& options)
      : frames_(frames), samples_(samples), rig_(rig), options_(options) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      for (const auto& [id, seen] : frames[k].seen) points_[id].sightings.emplace_back(k, seen);
    }
    // Two sightings, four rows, leave one row once the point has taken its three.
    std::erase_if(points_, [](const auto& p) { return p.second.sightings.size() < 3; });
  }

  std::optional<StartEstimate> solve() {
    if (static_cast<int>(points_.size()) < options_.min_landmarks) return std::nullopt;
    for (int i = 0; i < kStartIterations; ++i) {
      if (!integrate() || !step(i)) return std::nullopt;
    }
    return integrate() ? estimate() : std::nullopt;
  }

 private:
  bool integrate() {
    motions_.assign(1, {});
    for (std::size_t k = 1; k < frames_.size(); ++k) {
      const auto m =
          preintegrate(samples_, {frames_[0].t, frames_[k].t, rig_.time_offset_s}, globals_.bias);
      if (!m) return false;
      motions_.push_back(*m);
    }
    return true;
  }

  Eigen::Vector3d positionOf(std::size_t k) const {
    const double t = motions_[k].duration_s;
    return globals_.v * t + 0.5 * t * t * globals_.g + motions_[k].p;
  }

  Row row(std::size_t k, const Sighting& seen, const SeenPoint& point) const {
    const Preintegration& m = motions_[k];
    const Transform& T_SC = rig_.T_SC[seen.camera];
    const double t = m.duration_s;
    const Eigen::Vector3d p = point.p.value_or(Eigen::Vector3d::Zero());
    const Eigen::Vector3d y = m.R.transpose() * (p - positionOf(k));  // in S_k
    const Eigen::Vector3d p_C = T_SC.R.transpose() * (y - T_SC.t);
    // While the point has no place the equation is used as it is, linear in all unknowns: neither
    // the weight 1 / |p_C| nor a first guess is needed.
    // Once it has one, the weight is by its place of the step before, without derivative; the floor
    // [m] keeps a point that falls onto the camera from outweighing all others.
    const double w = point.p ? 1 / std::max(p_C.norm(), 0.1) : 1;
    const Eigen::Matrix<double, 2, 3> G = w * seen.M * T_SC.R.transpose();
    Row r;
    r.e = w * seen.M * p_C;
    r.J_point = G * m.R.transpose();
    r.J.leftCols<3>() = -t * r.J_point;
    r.J.middleCols<3>(3) = -0.5 * t * t * r.J_point;
    // R' y, with R <- R Exp(R_bg d): y + [y]x R_bg d; the position moves by p_bg d.
    r.J.middleCols<3>(6) = G * (skew(y) * m.R_bg - m.R.transpose() * m.p_bg);
    r.J.rightCols<3>() = -r.J_point * m.p_ba;
    return r;
  }

  /// Normal equations of the globals with the landmarks eliminated; solves and moves all.
  bool step(int iteration) {
    H_.setZero();
    GlobalVector b = GlobalVector::Zero();
    addPriors(iteration, b);
    struct Term {
      SeenPoint* point;
      Eigen::Matrix3d V_inverse = Eigen::Matrix3d::Zero();
      Eigen::Vector3d b = Eigen::Vector3d::Zero();
      Eigen::Matrix<double, kGlobals, 3> W = Eigen::Matrix<double, kGlobals, 3>::Zero();
    };
    std::vector<Term> terms;
    std::vector<double> squares;
    for (auto& [id, point] : points_) {
      Term term{&point};
      Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
      for (const auto& [k, seen] : point.sightings) {
        const Row r = row(k, seen, point);
        const double s = r.e.squaredNorm();
        // Cauchy (c = 2 sigma) once the points have their places: before, all errors are large.
        const double w = iteration < 3 ? 1 : 1 / (1 + s / 4);
        squares.push_back(s);
        H_ += w * r.J.transpose() * r.J;
        b += w * r.J.transpose() * r.e;
        V += w * r.J_point.transpose() * r.J_point;
        term.b += w * r.J_point.transpose() * r.e;
        term.W += w * r.J.transpose() * r.J_point;
      }
      V.diagonal().array() += 1e-9 * V.trace() + 1e-12;  // a point that no parallax places
      term.V_inverse = V.inverse();
      // The Schur complement of the point, as in a bundle adjustment.
      H_ -= term.W * term.V_inverse * term.W.transpose();
      b -= term.W * term.V_inverse * term.b;
      terms.push_back(term);
    }
    // Chi-square of two degrees of freedom: its median is 2 ln 2.
    rms_ = std::sqrt(median(std::move(squares)) / (2 * std::numbers::ln2));
    const GlobalVector d = -SymmetricFactor(H_).solve(b);
    if (!d.allFinite()) return false;
    globals_.v += d.head<3>();
    globals_.g += d.segment<3>(3);
    globals_.bias.gyro += d.segment<3>(6);
    globals_.bias.accel += d.tail<3>();
    for (const Term& term : terms) {
      const Eigen::Vector3d old = term.point->p.value_or(Eigen::Vector3d::Zero());
      term.point->p = old - term.V_inverse * (term.b + term.W.transpose() * d);
    }
    return true;
  }

  /// The first step is linear: biases stay, and gravity is free, for its direction is not known.
  void addPriors(int iteration, GlobalVector& b) {
    // 1e-5: as good as fixed.
    const double gyro = iteration == 0 ? 1e-5 : options_.gyro_bias_sigma;
    const double accel = iteration == 0 ? 1e-5 : options_.accel_bias_sigma;
    H_.diagonal().segment<3>(6).setConstant(1 / (gyro * gyro));
    H_.diagonal().tail<3>().setConstant(1 / (accel * accel));
    b.segment<3>(6) = globals_.bias.gyro / (gyro * gyro);
    b.tail<3>() = globals_.bias.accel / (accel * accel);
    // A deviation of 1000 m/s (m/s^2): only so that the system has a solution.
    H_.diagonal().head<6>().array() += 1e-6;
    if (options_.velocity_sigma) {
      const double still = 1 / (*options_.velocity_sigma * *options_.velocity_sigma);
      H_.diagonal().head<3>().array() += still;
      b.head<3>() += still * globals_.v;
    }
    if (iteration == 0) return;
    const double length = globals_.g.norm();
    const Eigen::Vector3d u = globals_.g / std::max(length, 1e-6);
    const double information = 1 / (options_.gravity_sigma * options_.gravity_sigma);
    H_.block<3, 3>(3, 3) += information * u * u.transpose();
    b.segment<3>(3) += information * (length - rig_.gravity_m_s2) * u;
  }

  std::optional<StartEstimate> estimate() const {
    StartEstimate out;
    out.rms = rms_;
    // Of whitened residuals, so that the inverse is the covariance; H_ is that of the last step.
    const GlobalMatrix P = SymmetricFactor(H_).inverse();
    out.velocity_std = std::sqrt(P.diagonal().head<3>().maxCoeff());
    // Of the vector g, over its length: an angle.
    out.tilt_std = std::sqrt(P.diagonal().segment<3>(3).maxCoeff()) / rig_.gravity_m_s2;
    const bool determined = out.rms < options_.max_rms &&
                            out.velocity_std < options_.max_velocity_std &&
                            out.tilt_std < options_.max_tilt_std;
    if (!determined) return std::nullopt;  // also for NaN
    // The yaw is free: the shortest turn that levels gravity.
    const Eigen::Matrix3d R_WS = shortestTurn(globals_.g, -Eigen::Vector3d::UnitZ());
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      out.states.push_back(
          {.T_FS = {Eigen::Matrix3d(R_WS * motions_[k].R), R_WS * positionOf(k)},
           .v_F = R_WS * (globals_.v + globals_.g * motions_[k].duration_s + motions_[k].v),
           .gyro_bias = globals_.bias.gyro,
           .accel_bias = globals_.bias.accel});
    }
    return out;
  }

  std::span<const StartFrame> frames_;
  std::span<const ImuSample> samples_;
  const RigModel& rig_;
  const StartOptions& options_;
  std::map<std::int64_t, SeenPoint> points_;
  std::vector<Preintegration> motions_;  // from the first frame to each
  Globals globals_;
  GlobalMatrix H_ = GlobalMatrix::Zero();
  double rms_ = 0;
};

}  // namespace

std::optional<StartEstimate> startEstimate(std::span<const StartFrame> frames,
                                           std::span<const ImuSample> samples, const RigModel& rig,
                                           const StartOptions& options) {
  options.check();
  if (frames.size() < 4) return std::nullopt;
  return StartProblem(frames, samples, rig, options).solve();
}

}  // namespace plumbline
