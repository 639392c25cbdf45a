// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/window_knowledge.h"

#include <cassert>
#include <numeric>
#include <vector>

#include "calibrator/linear/dense.h"

namespace plumbline {

std::optional<Eigen::MatrixXd> calibrationInformation(const Eigen::MatrixXd& information,
                                                      bool offset) {
  const int first = static_cast<int>(information.rows()) - BorderLayout::kFixed;
  assert(first >= 0);
  std::vector<int> keep(6);
  std::iota(keep.begin(), keep.end(), first);
  // Without `offset`, its row, the last one, is left out of the information: the offset is then
  // held.
  const int size = first + (offset ? BorderLayout::kFixed : BorderLayout::kOffset);
  if (offset) keep.push_back(size - 1);
  const auto cost =
      marginalised({information.topLeftCorner(size, size), Eigen::VectorXd::Zero(size), 0}, keep);
  if (!cost) return std::nullopt;
  return cost->H;
}

std::optional<Eigen::MatrixXd> calibrationCovariance(const WindowKnowledge& known,
                                                     const NoiseVariances& variances) {
  const auto size = known.information.rows();
  const int first = static_cast<int>(size) - BorderLayout::kFixed;
  std::vector<int> keep(6);
  std::iota(keep.begin(), keep.end(), first + BorderLayout::kExtrinsics);
  keep.push_back(first + BorderLayout::kOffset);
  const auto cost =
      marginalised({known.information, Eigen::VectorXd::Zero(size), 0, known.corners}, keep);
  const auto factor = cost ? scaledCholesky(cost->H) : std::nullopt;
  if (!factor) return std::nullopt;
  // A sandwich: the estimate weighs as if all variances were 1, the gradient scatters by the true
  // ones. What the corners do not bring of the information, the IMU does.
  const Eigen::VectorXd scale = factor->D.cwiseInverse();
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() *
      factor->llt.solve(Eigen::MatrixXd::Identity(cost->H.rows(), cost->H.rows())) *
      scale.asDiagonal();
  // H^-1 (v_imu (H - N) + v_corners N) H^-1, N the corners' noise.
  return inverse * (variances.imu * cost->H + (variances.corners - variances.imu) * cost->noise) *
         inverse;
}

}  // namespace plumbline
