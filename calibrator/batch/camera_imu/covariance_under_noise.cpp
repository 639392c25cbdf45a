// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <optional>
#include <utility>

#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {
namespace {

// What a group of rows brings of the border's information once the chain has followed it: with W
// the chain's response (chainResponses()), the sum of (W', 1) J' J (W', 1)' over the chain.

Eigen::MatrixXd cornersInBorder(const BlockArrow& corners,
                                const std::vector<ChainResponse>& responses) {
  const int m = corners.border();
  Eigen::MatrixXd out = corners.border_block.selfadjointView<Eigen::Upper>();
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const Eigen::MatrixXd W = responses[i];
    const Eigen::MatrixXd coupled = W.transpose() * corners.to_border[i].leftCols(m);
    out += coupled + coupled.transpose();
    out += W.transpose() * (corners.diagonal[i].selfadjointView<Eigen::Upper>() * W);
  }
  return out;
}

/// Of the four groups of a link's rows. Row by row: in the sum of their Gram's blocks what the rows
/// leave would be lost among what cancels.
std::optional<std::array<Eigen::MatrixXd, 4>> linksInBorder(
    const SolvedCameraImu& solved, const ImuWeights& weights,
    const std::vector<ChainResponse>& responses) {
  constexpr int kGravity = BorderLayout::kGravity;
  const auto& [problem, estimate] = solved;
  const auto m = responses.front().cols();
  std::array<Eigen::MatrixXd, 4> out;
  out.fill(Eigen::MatrixXd::Zero(m, m));
  const auto add = [&](std::size_t group, const Eigen::MatrixXd& rows) {
    out[group] += rows.transpose() * rows;
  };
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] == FrameLink::kBroken) continue;
    const Eigen::MatrixXd walk =
        weights[k].walk().asDiagonal() * (responses[k + 1] - responses[k]).bottomRows<6>();
    add(2, walk.topRows<3>());
    add(3, walk.bottomRows<3>());
    if (problem.links[k] != FrameLink::kInertial) continue;
    const auto J = motionRows(problem, estimate, weights, k, OffsetDerivative::kSmooth);
    if (!J) return std::nullopt;
    Eigen::MatrixXd rows =
        J->leftCols<15>() * responses[k] + J->middleCols<9>(15) * responses[k + 1].topRows<9>();
    rows.middleCols<3>(kGravity) += J->middleCols<3>(24);
    add(0, rows.topRows<3>());
    add(1, rows.bottomRows<6>());
  }
  return out;
}

}  // namespace

std::optional<Eigen::MatrixXd> covarianceUnder(const SolvedCameraImu& solved,
                                               const NoiseFactors& noise) {
  const auto& [problem, estimate] = solved;
  const auto weights = imuWeights(problem, estimate);
  if (!weights) return std::nullopt;
  auto normals = informationAt(problem, estimate, *weights);
  if (!normals) return std::nullopt;
  const auto chain = solveChain(normals->chain, {0, problem.threads});
  const auto responses = chainResponses(std::move(normals->chain), problem.threads);
  if (!chain || !responses) return std::nullopt;
  const auto links = linksInBorder(solved, *weights, *responses);
  if (!links) return std::nullopt;
  const auto more = [](double factor) { return factor * factor - 1; };
  // Of the gradient by the border: its information under the noise assumed, and what is more.
  Eigen::MatrixXd gradient = chain->border_information;
  gradient += more(noise.corner) *
              cornersInBorder(cameraInformationAt(problem, estimate).chain, *responses);
  gradient += more(noise.gyro) * (*links)[0] + more(noise.accel) * (*links)[1] +
              more(noise.gyro_bias) * (*links)[2] + more(noise.accel_bias) * (*links)[3];
  gradient(BorderLayout::kOffset, BorderLayout::kOffset) +=
      noise.samples * noise.samples * normals->offset_noise;
  const Eigen::MatrixXd inverse = borderCovariance(chain->border_information);
  // H^-1 V H^-1: the weights that the batch used, the noise that there is.
  const Eigen::MatrixXd full = inverse * gradient * inverse;
  constexpr int kT = BorderLayout::kExtrinsics;
  const std::array<int, 7> rows{kT, kT + 1, kT + 2, kT + 3, kT + 4, kT + 5, BorderLayout::kOffset};
  Eigen::MatrixXd covariance = full(rows, rows);
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace plumbline
