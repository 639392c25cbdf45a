// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrator/base/calibration.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

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

}  // namespace

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

}  // namespace plumbline
