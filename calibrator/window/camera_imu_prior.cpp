// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/camera_imu_prior.h"

#include <cassert>
#include <cmath>
#include <numeric>

#include "calibrator/base/lie.h"

namespace plumbline {
namespace {

constexpr int kState = kChainBlock;
constexpr int kSize = kState + BorderLayout::kFixed;

/// One block of the chain and the border, with what other blocks say of them left out.
QuadraticCost firstBlock(const BlockArrow& chain) {
  const int m = chain.border();
  QuadraticCost out{Eigen::MatrixXd::Zero(kState + m, kState + m), Eigen::VectorXd(kState + m), 0};
  out.H.topLeftCorner<kState, kState>() = chain.diagonal[0].selfadjointView<Eigen::Upper>();
  out.H.topRightCorner(kState, m) = chain.to_border[0].leftCols(m);
  out.H.bottomLeftCorner(m, kState) = out.H.topRightCorner(kState, m).transpose();
  out.H.bottomRightCorner(m, m) = chain.border_block.selfadjointView<Eigen::Upper>();
  out.b << chain.to_border[0].col(m), chain.border_gradient;
  return out;
}

/// `end` (block i, border) with block i + 1 put between them.
QuadraticCost joined(const QuadraticCost& end, const BlockArrow& chain, std::size_t i) {
  const int m = chain.border();
  const int size = 2 * kState + m;
  QuadraticCost out{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), end.c};
  out.H.topLeftCorner<kState, kState>() = end.H.topLeftCorner<kState, kState>();
  out.H.topRightCorner(kState, m) = end.H.topRightCorner(kState, m);
  out.H.bottomRightCorner(m, m) = end.H.bottomRightCorner(m, m);
  out.H.block<kState, kState>(0, kState) = chain.next[i];
  out.H.block<kState, kState>(kState, kState) =
      chain.diagonal[i + 1].selfadjointView<Eigen::Upper>();
  out.H.block(kState, 2 * kState, kState, m) = chain.to_border[i + 1].leftCols(m);
  out.H = Eigen::MatrixXd(out.H.selfadjointView<Eigen::Upper>());
  out.b << end.b.head<kState>(), chain.to_border[i + 1].col(m), end.b.tail(m);
  return out;
}

/// The d with boxplusDirection(from, d) == to.
Eigen::Vector2d directionMinus(const Eigen::Vector3d& to, const Eigen::Vector3d& from) {
  const Eigen::Vector2d across = tangentBasis(from).transpose() * to;
  const double sine = across.norm();
  if (sine < 1e-12) return across;
  return std::atan2(sine, from.dot(to)) / sine * across;
}

/// d displacement / d tangent at the estimate.
Eigen::MatrixXd jacobian(const CameraImuPrior& prior, const CameraImuEstimate& estimate,
                         const Eigen::VectorXd& d) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Identity(kSize, kSize);
  const int T = kState + BorderLayout::kExtrinsics;
  const int g = kState + BorderLayout::kGravity;
  J.block<3, 3>(3, 3) = inverseLeftJacobianSO3(d.segment<3>(3));
  J.block<3, 3>(T + 3, T + 3) = inverseLeftJacobianSO3(d.segment<3>(T + 3));
  J.block<2, 2>(g, g) =
      tangentBasis(prior.gravity_direction).transpose() * tangentBasis(estimate.gravity_direction);
  return J;
}

/// The first `count` frames' terms alone: the frame after them has no corners.
CameraImuProblem dropped(const CameraImuProblem& problem, int count) {
  const auto kept = static_cast<std::size_t>(count);
  CameraImuProblem out = problem;
  out.frames.resize(kept + 1);
  out.links.resize(kept);
  out.weights.resize(kept + 1);
  std::fill(out.frames.back().view.begin(), out.frames.back().view.end(), -1);
  return out;
}

}  // namespace

std::optional<QuadraticCost> frontEliminated(const BlockArrow& chain, int count) {
  assert(count >= 0 && count < chain.blocks());
  std::optional<QuadraticCost> end = firstBlock(chain);
  std::vector<int> keep(static_cast<std::size_t>(kState + chain.border()));
  std::iota(keep.begin(), keep.end(), kState);
  for (int i = 0; i < count && end; ++i) {
    end = marginalised(joined(*end, chain, static_cast<std::size_t>(i)), keep);
  }
  return end;
}

Eigen::VectorXd CameraImuPrior::displacement(const CameraImuEstimate& estimate) const {
  Eigen::VectorXd d(kSize);
  d << boxminus(estimate.states.front(), state), boxminus(estimate.T_SC0, T_SC0),
      directionMinus(estimate.gravity_direction, gravity_direction),
      estimate.time_offset_s - time_offset_s;
  return d;
}

double CameraImuPrior::costAt(const CameraImuEstimate& estimate) const {
  const Eigen::VectorXd d = displacement(estimate);
  return cost.c + cost.b.dot(d) + 0.5 * d.dot(cost.H * d);
}

void CameraImuPrior::addTo(const CameraImuEstimate& estimate, CameraImuNormals& normals) const {
  constexpr int m = BorderLayout::kFixed;
  const Eigen::VectorXd d = displacement(estimate);
  const Eigen::VectorXd Hd = cost.H * d;
  const Eigen::MatrixXd J = jacobian(*this, estimate, d);
  const Eigen::MatrixXd H = J.transpose() * cost.H * J;
  const Eigen::VectorXd b = J.transpose() * (cost.b + Hd);
  BlockArrow& chain = normals.chain;
  chain.diagonal[0] += H.topLeftCorner<kState, kState>();
  chain.to_border[0].leftCols(m) += H.topRightCorner(kState, m);
  chain.to_border[0].col(m) += b.head<kState>();
  chain.border_block += H.bottomRightCorner(m, m);
  chain.border_gradient += b.tail(m);
  normals.cost += cost.c + cost.b.dot(d) + 0.5 * d.dot(Hd);
}

std::optional<CameraImuPrior> marginaliseFront(const CameraImuProblem& problem,
                                               const CameraImuEstimate& estimate,
                                               const ImuWeights& weights,
                                               const std::optional<CameraImuPrior>& prior,
                                               int count) {
  assert(count > 0 && count < problem.frameCount() && !problem.free_cameras);
  auto normals = informationAt(dropped(problem, count), estimate, weights);
  if (!normals) return std::nullopt;
  assert(normals->chain.border() == BorderLayout::kFixed);
  if (prior) prior->addTo(estimate, *normals);
  auto cost = frontEliminated(normals->chain, count);
  if (!cost) return std::nullopt;
  cost->c += normals->cost;
  return CameraImuPrior{std::move(*cost), estimate.states[static_cast<std::size_t>(count)],
                        estimate.T_SC0, estimate.gravity_direction, estimate.time_offset_s};
}

}  // namespace plumbline
