// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/camera_imu_prior.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

constexpr int kState = kChainBlock;
constexpr int kSize = kState + BorderLayout::kFixed;

/// One block of the chain and the border, with what other blocks say of them left out.
Eigen::MatrixXd firstBlock(const BlockArrow& chain) {
  const int m = chain.border();
  Eigen::MatrixXd H(kState + m, kState + m);
  H.topLeftCorner<kState, kState>() = chain.diagonal[0].selfadjointView<Eigen::Upper>();
  H.topRightCorner(kState, m) = chain.to_border[0].leftCols(m);
  H.bottomLeftCorner(m, kState) = H.topRightCorner(kState, m).transpose();
  H.bottomRightCorner(m, m) = chain.border_block.selfadjointView<Eigen::Upper>();
  return H;
}

/// `end` (block i, border) with block i + 1 put between them: (block i, block i + 1, border), of
/// which the first is then eliminated. `end` holds the border's own block and all that earlier
/// blocks say; block i + 1 brings its diagonal and its coupling to the border.
Eigen::MatrixXd joined(const Eigen::MatrixXd& end, const BlockArrow& chain, std::size_t i) {
  const int m = chain.border();
  const int size = 2 * kState + m;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  H.topLeftCorner<kState, kState>() = end.topLeftCorner<kState, kState>();
  H.topRightCorner(kState, m) = end.topRightCorner(kState, m);
  H.bottomRightCorner(m, m) = end.bottomRightCorner(m, m);
  H.block<kState, kState>(0, kState) = chain.next[i];
  H.block<kState, kState>(kState, kState) = chain.diagonal[i + 1].selfadjointView<Eigen::Upper>();
  H.block(kState, 2 * kState, kState, m) = chain.to_border[i + 1].leftCols(m);
  return H.selfadjointView<Eigen::Upper>();
}

/// The same of the whole cost: the gradients likewise, the earlier cost carried along, and the
/// noise by the corners' part of the chain.
QuadraticCost joined(const QuadraticCost& end, const BlockArrow& chain, const BlockArrow& corners,
                     std::size_t i) {
  const int m = chain.border();
  QuadraticCost out{joined(end.H, chain, i), Eigen::VectorXd(2 * kState + m), end.c,
                    joined(end.noise, corners, i)};
  out.b << end.b.head<kState>(), chain.to_border[i + 1].col(m), end.b.tail(m);
  return out;
}

/// The d with boxplusDirection(from, d) == to; zero for opposite directions, which have none.
Eigen::Vector2d directionMinus(const Eigen::Vector3d& to, const Eigen::Vector3d& from) {
  const Eigen::Vector2d across = tangentBasis(from).transpose() * to;
  const double sine = across.norm();
  if (sine < 1e-12) return across;
  return std::atan2(sine, from.dot(to)) / sine * across;
}

/// The first `count` frames' terms alone: the frame after them has no corners.
CameraImuProblem dropped(const CameraImuProblem& problem, int count) {
  CameraImuProblem out = problem;
  out.frames.resize(count + 1);
  out.links.resize(count);
  out.weights.resize(count + 1);
  std::fill(out.frames.back().view.begin(), out.frames.back().view.end(), -1);
  return out;
}

/// Adds the prior's noise to the corners' part of a chain that begins with its state.
void addNoise(const CameraImuPrior& prior, const CameraImuEstimate& estimate, BlockArrow& corners) {
  constexpr int m = BorderLayout::kFixed;
  const Eigen::MatrixXd noise = prior.at(estimate).noise;
  corners.diagonal[0] += noise.topLeftCorner<kState, kState>();
  corners.to_border[0].leftCols(m) += noise.topRightCorner(kState, m);
  corners.border_block += noise.bottomRightCorner(m, m);
}

}  // namespace

std::optional<QuadraticCost> frontEliminated(const BlockArrow& chain, const BlockArrow& corners,
                                             int count) {
  assert(count >= 0 && count < chain.blocks() && corners.blocks() == chain.blocks());
  const int m = chain.border();
  std::optional<QuadraticCost> end =
      QuadraticCost{firstBlock(chain), Eigen::VectorXd(kState + m), 0, firstBlock(corners)};
  end->b << chain.to_border[0].col(m), chain.border_gradient;
  // Of (leaving block, next block, border) all but the first 15 stay.
  std::vector<int> keep(kState + m);
  std::iota(keep.begin(), keep.end(), kState);
  for (int i = 0; i < count && end; ++i) {
    end = marginalised(joined(*end, chain, corners, i), keep);
  }
  return end;
}

Displacement displacementOf(const CameraImuEstimate& to, const CameraImuEstimate& from) {
  constexpr int T = kState + BorderLayout::kExtrinsics;
  constexpr int g = kState + BorderLayout::kGravity;
  Displacement out{Eigen::VectorXd(kSize), Eigen::MatrixXd::Identity(kSize, kSize)};
  out.d << boxminus(to.states.front(), from.states.front()), boxminus(to.T_SC0, from.T_SC0),
      directionMinus(to.gravity_direction, from.gravity_direction),
      to.timeOffset() - from.timeOffset();
  // Log(Exp(da) R_to R_from') = d + Jl^-1(d) da. For gravity, to first order in d, a change of
  // basis.
  out.J.block<3, 3>(3, 3) = inverseLeftJacobianSO3(out.d.segment<3>(3));
  out.J.block<3, 3>(T + 3, T + 3) = inverseLeftJacobianSO3(out.d.segment<3>(T + 3));
  out.J.block<2, 2>(g, g) =
      tangentBasis(from.gravity_direction).transpose() * tangentBasis(to.gravity_direction);
  return out;
}

void addPrior(const CameraImuPrior& prior, const CameraImuEstimate& estimate,
              CameraImuNormals& normals) {
  constexpr int m = BorderLayout::kFixed;
  const QuadraticCost at = prior.at(estimate);
  BlockArrow& chain = normals.chain;
  // Its state is the window's first, and its border the chain's: cameras are fixed, so that the
  // border has nothing beyond BorderLayout::kFixed.
  chain.diagonal[0] += at.H.topLeftCorner<kState, kState>();
  chain.to_border[0].leftCols(m) += at.H.topRightCorner(kState, m);
  chain.to_border[0].col(m) += at.b.head<kState>();
  chain.border_block += at.H.bottomRightCorner(m, m);
  chain.border_gradient += at.b.tail(m);
  normals.cost += at.c;
}

std::optional<QuadraticCost> frontCost(const CameraImuProblem& problem,
                                       const CameraImuEstimate& estimate, const ImuWeights& weights,
                                       const std::optional<CameraImuPrior>& prior, int count) {
  auto normals = informationAt(problem, estimate, weights);
  if (!normals) return std::nullopt;
  assert(normals->chain.border() == BorderLayout::kFixed);
  BlockArrow corners = cameraInformationAt(problem, estimate).chain;
  if (prior) {
    addPrior(*prior, estimate, *normals);
    addNoise(*prior, estimate, corners);
  }
  auto cost = frontEliminated(normals->chain, corners, count);
  // frontEliminated() starts at a cost of 0; the terms' own (and the prior's) comes on top.
  if (cost) cost->c += normals->cost;
  return cost;
}

std::optional<CameraImuPrior> marginaliseFront(const CameraImuProblem& problem,
                                               const CameraImuEstimate& estimate,
                                               const ImuWeights& weights,
                                               const std::optional<CameraImuPrior>& prior,
                                               int count) {
  assert(count > 0 && count < problem.frameCount() && !problem.free_cameras);
  // Linearised where the estimate is now, for the last time.
  auto cost = frontCost(dropped(problem, count), estimate, weights, prior, count);
  if (!cost) return std::nullopt;
  CameraImuEstimate point = estimate;
  point.states = {estimate.states[count]};
  return CameraImuPrior{std::move(*cost), std::move(point)};
}

}  // namespace plumbline
