// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/hand_eye.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/linear/levenberg_marquardt.h"

namespace plumbline {
namespace {

constexpr std::size_t kFewest = 10;
constexpr int kRounds = 4;            // of noise and solution
constexpr double kNoSmaller = 1e-12;  // [m, rad] exact data are weighted as if so noisy
constexpr double kImplausibleRms = 20 / kDegrees;
constexpr double kImplausibleShare = 0.25;  // of the positions' spread

struct Noise {
  double sigma_m = 1, sigma_rad = 1;
};

/// Of the unknowns (T_SM (6), T_VW (6), and where it is free the offset (1)).
struct Normals {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  double cost = 0;
};

Normals normalsAt(std::span<const HandEyePair> pairs, const HandEyeState& state, const Noise& noise,
                  bool with_offset) {
  const int n = with_offset ? 13 : 12;
  Vector6d weights;
  weights << Eigen::Vector3d::Constant(1 / noise.sigma_m),
      Eigen::Vector3d::Constant(1 / noise.sigma_rad);
  Normals sum{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, n);
  for (const HandEyePair& pair : pairs) {
    const HandEyeResidual e = handEyeResidual(pair, state);
    J.leftCols<6>() = e.J_SM;
    J.middleCols<6>(6) = e.J_VW;
    if (with_offset) J.col(12) = e.J_offset;
    J = weights.asDiagonal() * J;
    const Vector6d r = weights.cwiseProduct(e.r);
    sum.H += J.transpose() * J;
    sum.b += J.transpose() * r;
    sum.cost += 0.5 * r.squaredNorm();
  }
  return sum;
}

/// As minimise() wants it.
class HandEyeSteps {
 public:
  HandEyeSteps(std::span<const HandEyePair> pairs, const HandEyeState& start, const Noise& noise,
               bool with_offset)
      : pairs_(pairs), noise_(noise), with_offset_(with_offset), state_(start), now_(at(start)) {}

  double cost() const { return now_.cost; }
  const HandEyeState& state() const { return state_; }

  std::optional<double> solve(double damping) {
    Eigen::MatrixXd H = now_.H;
    // By shares of the diagonal: metres, radians and seconds have no common unit.
    H.diagonal() *= 1 + damping;
    const Eigen::LLT<Eigen::MatrixXd> llt(H);
    if (llt.info() != Eigen::Success) return std::nullopt;
    step_ = -llt.solve(now_.b);
    return -step_.dot(now_.b);
  }

  Trial attempt() {
    next_state_ = {boxplus(state_.T_SM, step_.head<6>()), boxplus(state_.T_VW, step_.segment<6>(6)),
                   state_.offset_s + (with_offset_ ? step_[12] : 0)};
    next_ = at(next_state_);
    return {.cost = next_.cost};
  }

  void accept() {
    state_ = next_state_;
    now_ = std::move(next_);
  }

  static bool refuse() { return false; }

 private:
  Normals at(const HandEyeState& state) const {
    return normalsAt(pairs_, state, noise_, with_offset_);
  }

  std::span<const HandEyePair> pairs_;
  Noise noise_;
  bool with_offset_;
  HandEyeState state_, next_state_;
  Normals now_, next_;
  Eigen::VectorXd step_;
};

// R_SM with Log(R_WSi^T R_WSj) = R_SM Log(R_VMi^T R_VMj), over pairs a fiftieth of them apart.
Eigen::Matrix3d bodyRotation(std::span<const HandEyePair> pairs) {
  // Near half a turn noise decides which way round the rotation vector points.
  constexpr double kAmbiguous = 170 / kDegrees;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  // Neighbours have hardly turned: the noise of both poses would outweigh it.
  const std::size_t step = pairs.size() / 50 + 1;
  for (std::size_t i = 0; i + step < pairs.size(); ++i) {
    const HandEyePair& a = pairs[i];
    const HandEyePair& b = pairs[i + step];
    const Eigen::Vector3d turn_S = logSO3(a.T_WS.R.transpose() * b.T_WS.R);
    const Eigen::Vector3d turn_M = logSO3(a.T_VM.R.transpose() * b.T_VM.R);
    if (turn_S.norm() < kAmbiguous) sum += turn_S * turn_M.transpose();
  }
  // Wahba's problem: the sum of outer products has its solution.
  return nearestRotation(sum);
}

/// R_VW that brings R_WS R_SM nearest to R_VM over all pairs, R_SM known.
Eigen::Matrix3d worldRotation(std::span<const HandEyePair> pairs, const Eigen::Matrix3d& R_SM) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const HandEyePair& p : pairs) sum += p.T_VM.R * (p.T_WS.R * R_SM).transpose();
  return nearestRotation(sum);
}

// Rotations first; then R_VW R_WS t_SM + t_VW = t_VM - R_VW t_WS is linear in the translations.
HandEyeState startOf(std::span<const HandEyePair> pairs) {
  HandEyeState state;
  state.T_SM.R = bodyRotation(pairs);
  state.T_VW.R = worldRotation(pairs, state.T_SM.R);
  Matrix6d A = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  for (const HandEyePair& p : pairs) {
    Eigen::Matrix<double, 3, 6> J;
    J << state.T_VW.R * p.T_WS.R, Eigen::Matrix3d::Identity();
    A += J.transpose() * J;
    b += J.transpose() * (p.T_VM.t - state.T_VW.R * p.T_WS.t);
  }
  const Vector6d x = SymmetricFactor(A).solve(b);
  state.T_SM.t = x.head<3>();
  state.T_VW.t = x.tail<3>();
  return state;
}

struct Squares {
  double translation = 0, rotation = 0;
};

Squares squaresOf(std::span<const HandEyePair> pairs, const HandEyeState& state) {
  Squares sum;
  for (const HandEyePair& pair : pairs) {
    const Vector6d r = handEyeResidual(pair, state).r;
    sum.translation += r.head<3>().squaredNorm();
    sum.rotation += r.tail<3>().squaredNorm();
  }
  return sum;
}

// What is given, and the rest from the residuals; each part has about half of the unknowns.
Noise noiseOf(const Squares& squares, std::size_t pairs, const HandEyeOptions& options) {
  const double freedom = 3 * static_cast<double>(pairs) - (options.with_offset ? 6.5 : 6);
  const auto from = [&](double given, double sum) {
    if (given > 0) return given;
    const double rms = std::sqrt(sum / freedom);
    return rms < kNoSmaller ? kNoSmaller : rms;  // NaN stays NaN
  };
  return {from(options.sigma_m, squares.translation), from(options.sigma_rad, squares.rotation)};
}

std::optional<HandEyeState> refined(std::span<const HandEyePair> pairs, const HandEyeState& start,
                                    const Noise& noise, bool with_offset) {
  HandEyeSteps steps(pairs, start, noise, with_offset);
  const MinimiserSummary end = minimise(steps, {.tolerance = 1e-4});
  // Exact pairs leave nothing but rounding: no step lowers the cost. The last one was short, or as
  // long as the rounding of many pairs under a noise that is set, not found.
  const bool exact = noise.sigma_m == kNoSmaller && noise.sigma_rad == kNoSmaller;
  if (!end.converged() && !exact && !(end.last_step < 1e-2)) return std::nullopt;
  return steps.state();
}

Eigen::MatrixXd handEyeCovariance(std::span<const HandEyePair> pairs, const HandEyeState& state,
                                  const Noise& noise, bool with_offset) {
  const Normals at = normalsAt(pairs, state, noise, with_offset);
  const auto n = at.H.rows();
  const double freedom = 6 * static_cast<double>(pairs.size()) - static_cast<double>(n);
  // Chi-square over its degrees of freedom makes up for a stated noise that does not fit.
  return SymmetricFactor(at.H).inverse() * (2 * at.cost / freedom);
}

// sum (R - mean)^T (R - mean) / n = I - mean^T mean: the squares by which the end of a unit lever
// in S spreads in W; zero along an axis about which alone S turns.
std::optional<Failure> unseenDirection(std::span<const HandEyePair> pairs,
                                       const HandEyeOptions& options) {
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (const HandEyePair& p : pairs) mean += p.T_WS.R / static_cast<double>(pairs.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(Eigen::Matrix3d::Identity() -
                                                             mean.transpose() * mean);
  const Eigen::Vector3d spread = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  // Noise alone spreads the lever by about sigma_rad.
  const double needed = std::max(options.min_turn_rad, 5 * options.sigma_rad);
  if (spread[0] >= needed) return std::nullopt;
  // The sign of an eigenvector is arbitrary: the same one in every message.
  Eigen::Vector3d a = eigen.eigenvectors().col(0);
  Eigen::Index largest = 0;
  a.cwiseAbs().maxCoeff(&largest);
  if (a[largest] < 0) a = -a;
  // Ascending: a turn about one axis spreads levers along the other two.
  const bool still = spread[1] < needed;
  Failure failure{still ? FailureCode::kHandEyeNoRotation : FailureCode::kHandEyeOneAxis,
                  {{"across", spread[0]}, {"needed", needed}}};
  if (!still) failure.values.emplace("axis", a);
  return failure;
}

// RMS distance of M's origins from their mean.
double spreadOf(std::span<const HandEyePair> pairs) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const HandEyePair& p : pairs) mean += p.T_VM.t / static_cast<double>(pairs.size());
  double sum = 0;
  for (const HandEyePair& p : pairs) sum += (p.T_VM.t - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

}  // namespace

HandEyeResidual handEyeResidual(const HandEyePair& pair, const HandEyeState& state) {
  const Eigen::Matrix3d R_VS = state.T_VW.R * pair.T_WS.R;
  const Transform T_WM = pair.T_WS * state.T_SM;
  const Transform P = state.T_VW * T_WM;
  const Eigen::Matrix3d R_VM = expSO3(state.offset_s * pair.omega_V) * pair.T_VM.R;
  const Eigen::Vector3d angle = logSO3(P.R * R_VM.transpose());

  HandEyeResidual out;
  out.r << P.t - pair.T_VM.t - state.offset_s * pair.v_V, angle;
  const Eigen::Matrix3d Jl = inverseLeftJacobianSO3(angle);
  // P.R = R_VS R_SM: a turn a of R_SM, on its left, is R_VS a on the left of P.R. One of R_VW, x,
  // turns what R_VW carries over, without t_VW: -[R_VW t_WM]x.
  out.J_SM.topLeftCorner<3, 3>() = R_VS;
  out.J_SM.bottomRightCorner<3, 3>() = Jl * R_VS;
  out.J_VW.topLeftCorner<3, 3>().setIdentity();
  out.J_VW.topRightCorner<3, 3>() = -skew(state.T_VW.R * T_WM.t);
  out.J_VW.bottomRightCorner<3, 3>() = Jl;
  // R_VM' stands on the right: Log(E Exp(-x)) = Log(E) - Jr^-1(Log E) x.
  out.J_offset << -pair.v_V, -inverseRightJacobianSO3(angle) * pair.omega_V;
  return out;
}

void HandEyeOptions::check() const {
  requireAtLeast(0, "sigma_m", sigma_m);
  requireAtLeast(0, "sigma_rad", sigma_rad);
  requireAtLeast(0, "min_turn_rad", min_turn_rad);
}

Result<HandEye> estimateHandEye(std::span<const HandEyePair> pairs, const HandEyeOptions& options) {
  options.check();
  if (pairs.size() < kFewest) {
    return Failure{FailureCode::kHandEyeTooFewPairs,
                   {{"pairs", pairs.size()}, {"needed", kFewest}}};
  }
  // Before the start: without turns about two axes its linear systems are singular.
  if (const auto unseen = unseenDirection(pairs, options)) return *unseen;
  const auto n = static_cast<double>(pairs.size());
  HandEye out;
  out.state = startOf(pairs);
  Squares squares = squaresOf(pairs, out.state);
  if (std::sqrt(squares.rotation / n) > kImplausibleRms) {
    return Failure{FailureCode::kHandEyeRotationsDisagree,
                   {{"rms_deg", kDegrees * std::sqrt(squares.rotation / n)}}};
  }
  // In turn: the weights follow from the residuals, and these from the weights.
  for (int round = 0; round < kRounds; ++round) {
    const Noise noise = noiseOf(squares, pairs.size(), options);
    const auto state = refined(pairs, out.state, noise, options.with_offset);
    if (!state) return Failure{FailureCode::kHandEyeNotConverged};
    out.state = *state;
    squares = squaresOf(pairs, out.state);
  }
  const Noise noise = noiseOf(squares, pairs.size(), options);
  out.covariance = handEyeCovariance(pairs, out.state, noise, options.with_offset);
  out.sigma_m = noise.sigma_m;
  out.sigma_rad = noise.sigma_rad;
  out.rms_translation_m = std::sqrt(squares.translation / n);
  out.rms_rotation_rad = std::sqrt(squares.rotation / n);
  // Against the motion's own size: rotations may agree where the positions are of another scale or
  // unit.
  const double spread = spreadOf(pairs);
  if (out.rms_translation_m > kImplausibleShare * spread) {
    return Failure{FailureCode::kHandEyePositionsDisagree,
                   {{"rms_m", out.rms_translation_m}, {"distance_m", spread}}};
  }
  out.pairs = pairs.size();
  return out;
}

}  // namespace plumbline
