// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/hand_eye.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include "calibrator/base/option_check.h"
#include "calibrator/base/transform.h"

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

/// The state after steps in the tangents of T_SM and T_VW, six numbers each.
HandEyeState moved(const HandEyeState& state, const double* d_SM, const double* d_VW,
                   double offset_s) {
  return {boxplus(state.T_SM, Eigen::Map<const Vector6d>(d_SM)),
          boxplus(state.T_VW, Eigen::Map<const Vector6d>(d_VW)), state.offset_s + offset_s};
}

// Steps from `start` to Jacobians by the steps: the rotation's left Jacobian comes on top.
class PairCost final : public ceres::SizedCostFunction<6, 6, 6, 1> {
 public:
  PairCost(const HandEyePair& pair, const HandEyeState& start, const Noise& noise)
      : pair_(pair), start_(start) {
    weights_ << Eigen::Vector3d::Constant(1 / noise.sigma_m),
        Eigen::Vector3d::Constant(1 / noise.sigma_rad);
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const HandEyeResidual e = handEyeResidual(pair_, moved(start_, x[0], x[1], *x[2]));
    writeVector(e.r, residuals);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) write(byStep(e.J_SM, x[0]), jacobians[0]);
    if (jacobians[1] != nullptr) write(byStep(e.J_VW, x[1]), jacobians[1]);
    if (jacobians[2] != nullptr) writeVector(e.J_offset, jacobians[2]);
    return true;
  }

 private:
  static Matrix6d byStep(Matrix6d J, const double* step) {
    const Eigen::Vector3d angle = Eigen::Map<const Eigen::Vector3d>(step + 3);
    J.rightCols<3>() = (J.rightCols<3>() * leftJacobianSO3(angle)).eval();
    return J;
  }
  void writeVector(const Vector6d& v, double* out) const {
    Eigen::Map<Vector6d> column(out);
    column = weights_.cwiseProduct(v);
  }
  void write(const Matrix6d& J, double* out) const {
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> rows(out);
    rows = weights_.asDiagonal() * J;
  }

  const HandEyePair& pair_;
  const HandEyeState& start_;
  Vector6d weights_;
};

// R_SM with Log(R_WSi^T R_WSj) = R_SM Log(R_VMi^T R_VMj), over pairs a fiftieth of them apart.
Eigen::Matrix3d bodyRotation(std::span<const HandEyePair> pairs) {
  // Near half a turn noise decides which way round the rotation vector points.
  constexpr double kAmbiguous = 170 / kDegrees;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const std::size_t step = pairs.size() / 50 + 1;
  for (std::size_t i = 0; i + step < pairs.size(); ++i) {
    const HandEyePair& a = pairs[i];
    const HandEyePair& b = pairs[i + step];
    const Eigen::Vector3d turn_S = logSO3(a.T_WS.R.transpose() * b.T_WS.R);
    const Eigen::Vector3d turn_M = logSO3(a.T_VM.R.transpose() * b.T_VM.R);
    if (turn_S.norm() < kAmbiguous) sum += turn_S * turn_M.transpose();
  }
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
  const Vector6d x = A.ldlt().solve(b);
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
    return given > 0 ? given : std::max(kNoSmaller, std::sqrt(sum / freedom));
  };
  return {from(options.sigma_m, squares.translation), from(options.sigma_rad, squares.rotation)};
}

std::optional<HandEyeState> refined(std::span<const HandEyePair> pairs, const HandEyeState& start,
                                    const Noise& noise, bool with_offset) {
  // The unknowns are steps from `start`: plain vectors, which need no manifold.
  Vector6d d_SM = Vector6d::Zero(), d_VW = Vector6d::Zero();
  double offset_s = 0;
  ceres::Problem problem;
  for (const HandEyePair& pair : pairs) {
    problem.AddResidualBlock(new PairCost(pair, start, noise), nullptr, d_SM.data(), d_VW.data(),
                             &offset_s);
  }
  if (!with_offset) problem.SetParameterBlockConstant(&offset_s);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return std::nullopt;
  return moved(start, d_SM.data(), d_VW.data(), offset_s);
}

Eigen::MatrixXd covarianceOf(std::span<const HandEyePair> pairs, const HandEyeState& state,
                             const Noise& noise, bool with_offset) {
  const int n = with_offset ? 13 : 12;
  Vector6d weights;
  weights << Eigen::Vector3d::Constant(1 / noise.sigma_m),
      Eigen::Vector3d::Constant(1 / noise.sigma_rad);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  double chi2 = 0;
  for (const HandEyePair& pair : pairs) {
    const HandEyeResidual e = handEyeResidual(pair, state);
    Eigen::MatrixXd J(6, n);
    J.leftCols<6>() = e.J_SM;
    J.middleCols<6>(6) = e.J_VW;
    if (with_offset) J.col(12) = e.J_offset;
    J = weights.asDiagonal() * J;
    A += J.transpose() * J;
    chi2 += weights.cwiseProduct(e.r).squaredNorm();
  }
  // By how much a noise that was given is too small or too large; 1 where both are from the
  // residuals, whose degrees of freedom add up to these.
  const double freedom = 6 * static_cast<double>(pairs.size()) - n;
  return A.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) * (chi2 / freedom);
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
    if (!state) {
      return Failure{FailureCode::kHandEyeNotConverged};
    }
    out.state = *state;
    squares = squaresOf(pairs, out.state);
  }
  const Noise noise = noiseOf(squares, pairs.size(), options);
  out.covariance = covarianceOf(pairs, out.state, noise, options.with_offset);
  out.sigma_m = noise.sigma_m;
  out.sigma_rad = noise.sigma_rad;
  out.rms_translation_m = std::sqrt(squares.translation / n);
  out.rms_rotation_rad = std::sqrt(squares.rotation / n);
  const double spread = spreadOf(pairs);
  if (out.rms_translation_m > kImplausibleShare * spread) {
    return Failure{FailureCode::kHandEyePositionsDisagree,
                   {{"rms_m", out.rms_translation_m}, {"distance_m", spread}}};
  }
  out.pairs = pairs.size();
  return out;
}

}  // namespace plumbline
