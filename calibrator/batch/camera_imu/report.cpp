// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/parallel.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/information/covariance.h"
#include "calibrator/linear/dense.h"

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

/// Rows of the border that are calibration parameters, with their names and units.
struct ParameterList {
  std::vector<int> rows;
  std::vector<ParameterName> parameters;
  /// Those from here on are camera 0's offset plus their row.
  std::size_t own_offsets = 0;

  void add(int first_row, const std::vector<ParameterName>& more) {
    for (const ParameterName& p : more) {
      rows.push_back(first_row++);
      parameters.push_back(p);
    }
  }
};

ParameterList parameterList(const CameraImuEstimate& estimate, bool free_cameras) {
  ParameterList list;
  list.add(BorderLayout::kExtrinsics, transformParameters("T_SC0"));
  list.add(BorderLayout::kOffset, {{"time_offset", "s"}});
  // The border lists the cameras' parameters as their own stage does.
  if (free_cameras) list.add(BorderLayout::kFixed, cameraParameters(estimate.cameras));
  list.own_offsets = list.rows.size();
  return list;
}

/// With the offsets of cameras that have their own behind.
ParameterList withOwnOffsets(ParameterList list, const CameraImuEstimate& estimate,
                             bool free_cameras) {
  const BorderLayout layout(estimate, free_cameras);
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    if (layout.own_offset[c] < 0) continue;
    list.add(layout.own_offset[c], {{"time_offset." + parameterOwner(estimate.cameras, c), "s"}});
  }
  return list;
}

/// J of the listed parameters by the border, where an own offset is camera 0's plus the difference
/// that its column holds.
Eigen::MatrixXd rowsOf(const ParameterList& list, int border) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(list.rows.size(), border);
  for (std::size_t i = 0; i < list.rows.size(); ++i) {
    J(i, list.rows[i]) = 1;
    if (i >= list.own_offsets) J(i, BorderLayout::kOffset) = 1;
  }
  return J;
}

/// Covariance of the border's first `size` parameters, the others held. With the solution's own
/// weights of the intervals, not with renewed ones: of the cost that was minimised.
std::optional<Eigen::MatrixXd> sandwich(const CameraImuProblem& problem,
                                        const CameraImuSolution& solution, int size) {
  const auto normals = informationAt(problem, solution.estimate, solution.weights);
  const auto chain = normals ? solveChain(normals->chain, {0, problem.threads}) : std::nullopt;
  if (!chain) return std::nullopt;
  Eigen::MatrixXd full = borderCovariance(chain->border_information.topLeftCorner(size, size));
  // Sandwich: the gradient by t_d varies by more than the information says, by the variance n.
  // H^-1 (H + n e e^T) H^-1 = H^-1 + n h h^T, e the offset's unit vector and h its column of H^-1.
  const Eigen::VectorXd offset = full.col(BorderLayout::kOffset);
  full += normals->offset_noise * offset * offset.transpose();
  return full;
}

/// Of a variance that rounding may have made negative. One that is no number stays so.
double deviationOf(double variance) { return std::sqrt(std::max(variance, 0.0)); }

/// The worst direction of a 3 x 3 covariance and its deviation, where that exceeds the limit or is
/// no number.
struct Loose {
  Eigen::Vector3d axis;
  double deviation = 0;
};
/// Not axis by axis: what a turn about one axis leaves free seldom lies along x, y or z.
std::optional<Loose> looseDirection(const Eigen::Matrix3d& covariance, double limit) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const double deviation = deviationOf(eigen.eigenvalues()(2));
  if (deviation <= limit && covariance.allFinite()) return std::nullopt;
  return Loose{eigen.eigenvectors().col(2), deviation};
}

/// Every group is looked at, so that one message names all that is loose.
std::optional<Failure> unobservable(const Eigen::MatrixXd& covariance,
                                    const CameraImuOptions& options) {
  Failure failure{FailureCode::kLooseDirections};
  if (const auto t =
          looseDirection(covariance.topLeftCorner<3, 3>(), options.max_translation_std_m)) {
    failure.values.emplace("translation_axis", t->axis);
    failure.values.emplace("translation_std_m", t->deviation);
  }
  if (const auto r = looseDirection(covariance.block<3, 3>(3, 3), options.max_rotation_std_rad)) {
    failure.values.emplace("rotation_axis", r->axis);
    failure.values.emplace("rotation_std_rad", r->deviation);
  }
  const double offset = deviationOf(covariance(6, 6));
  if (!(offset <= options.max_offset_std_s)) failure.values.emplace("offset_std_s", offset);
  if (failure.values.empty()) return std::nullopt;
  return failure;
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

void setCovariance(ParameterCovariance covariance, StageSummary& summary) {
  summary.entropy_nats =
      entropyNatsOfCovariance(covariance.matrix).value_or(std::numeric_limits<double>::quiet_NaN());
  summary.covariance = std::move(covariance);
}

Eigen::MatrixXd borderCovariance(const Eigen::MatrixXd& information) {
  // An information far weaker than any useful measurement, and its share of what there is.
  constexpr double kNoInformation = 1e-12;
  constexpr double kWeakPrior = 1e-13;
  return finiteInverse(information, kNoInformation, kWeakPrior);
}

Eigen::MatrixXd listedByBorder(const CameraImuEstimate& estimate, bool free_cameras) {
  const ParameterList list =
      withOwnOffsets(parameterList(estimate, free_cameras), estimate, free_cameras);
  return rowsOf(list, BorderLayout(estimate, free_cameras).size);
}

Result<ParameterCovariance> cameraImuCovariance(const CameraImuProblem& problem,
                                                const CameraImuSolution& solution,
                                                const CameraImuOptions& options) {
  const CameraImuEstimate& estimate = solution.estimate;
  const ParameterList list =
      withOwnOffsets(parameterList(estimate, problem.free_cameras), estimate, problem.free_cameras);
  const Eigen::MatrixXd J = rowsOf(list, BorderLayout(estimate, problem.free_cameras).size);
  const auto full = sandwich(problem, solution, static_cast<int>(J.cols()));
  if (!full) return Failure{FailureCode::kMotionInformationSingular};
  const Eigen::MatrixXd listed = J * *full * J.transpose();
  ParameterCovariance out =
      parameterCovariance(list.parameters, 0.5 * (listed + listed.transpose()));
  if (const auto failure = unobservable(out.matrix, options)) return *failure;
  return out;
}

std::optional<ParameterCovariance> fixedCovariance(CameraImuProblem problem,
                                                   const CameraImuSolution& solution,
                                                   double cauchy_px) {
  // Linearised as if the calibration were free, at the values that it was held at.
  problem.fixed_calibration = false;
  problem.free_cameras = false;
  problem.gram.cauchy_px = cauchy_px;
  // Own offsets stand behind: leaving them out holds them.
  const auto full = sandwich(problem, solution, BorderLayout::kFixed);
  if (!full) return std::nullopt;
  const ParameterList list = parameterList(solution.estimate, false);
  ParameterCovariance out = parameterCovariance(list.parameters, (*full)(list.rows, list.rows));
  if (!out.matrix.allFinite() || Eigen::LLT<Eigen::MatrixXd>(out.matrix).info() != Eigen::Success) {
    return std::nullopt;
  }
  return out;
}

std::optional<ImuStateCovariances> stateCovariances(const CameraImuProblem& problem,
                                                    const CameraImuSolution& solution) {
  const auto normals = informationAt(problem, solution.estimate, solution.weights);
  if (!normals) return std::nullopt;
  auto inverse = invertChain(normals->chain, {0, problem.threads});
  if (!inverse) return std::nullopt;
  ChainCovariance& S = inverse->covariance;
  constexpr int kOffset = BorderLayout::kOffset;
  constexpr int kGravity = BorderLayout::kGravity;
  ImuStateCovariances out;
  out.states = std::move(S.diagonal);
  for (std::size_t i = 0; i < out.states.size(); ++i) {
    const Eigen::Matrix<double, kChainBlock, 1> offset = S.to_border[i].col(kOffset);
    // The sandwich of cameraImuCovariance(), of the state's rows of H^-1.
    out.states[i] += normals->offset_noise * offset * offset.transpose();
  }
  const Eigen::Vector2d offset = S.border.block<2, 1>(kGravity, kOffset);
  out.gravity_direction = S.border.block<2, 2>(kGravity, kGravity) +
                          normals->offset_noise * offset * offset.transpose();
  return out;
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
    free += b.dot(H.ldlt().solve(b));
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
