// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/effective_scores.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/linear/block_arrow.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Adds U' H U and U' b of a view, the first six rows of U being T and the others unit vectors of
/// its own columns; only the first T.cols() columns of the border.
template <class Top>
void addGram(const FaultViewTerms& v, const Top& T, MatrixXd& information, VectorXd& gradient) {
  const Index n = T.cols();
  information.noalias() += T.transpose() * (v.H.topLeftCorner<6, 6>() * T).eval();
  gradient.noalias() += T.transpose() * v.b.head<6>();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    const Index row = 6 + static_cast<Index>(i);
    const Index column = v.own[i];
    if (column >= n) continue;
    const VectorXd cross = T.transpose() * v.H.col(row).head<6>();
    information.col(column) += cross;
    information.row(column) += cross.transpose();
    for (std::size_t j = 0; j < v.own.size(); ++j) {
      if (v.own[j] < n) information(column, v.own[j]) += v.H(row, 6 + static_cast<Index>(j));
    }
    gradient(column) += v.b(row);
  }
}

/// The first n columns of the border.
void addView(const FaultViewTerms& v, Index n, BlockArrow& chain) {
  const auto T = v.A_B.leftCols(n);
  const Eigen::Matrix<double, kChainBlock, 6> AxH = v.A_x.transpose() * v.H.topLeftCorner<6, 6>();
  chain.diagonal[v.frame] += AxH * v.A_x;
  ChainBorderRows& rows = chain.to_border[v.frame];
  rows.leftCols(n) += AxH * T;
  rows.col(n) += v.A_x.transpose() * v.b.head<6>();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    if (v.own[i] >= n) continue;
    rows.col(v.own[i]) += v.A_x.transpose() * v.H.col(6 + static_cast<Index>(i)).head<6>();
  }
  addGram(v, T, chain.border_block, chain.border_gradient);
}

void addLink(const LinkTerms& t, Index n, BlockArrow& chain) {
  const auto J_B = t.J_B.leftCols(n);
  chain.diagonal[t.at] += t.J_i.transpose() * t.J_i;
  chain.next[t.at] += t.J_i.transpose() * t.J_j;
  chain.diagonal[t.at + 1] += t.J_j.transpose() * t.J_j;
  chain.to_border[t.at].leftCols(n) += t.J_i.transpose() * J_B;
  chain.to_border[t.at].col(n) += t.J_i.transpose() * t.r;
  chain.to_border[t.at + 1].leftCols(n) += t.J_j.transpose() * J_B;
  chain.to_border[t.at + 1].col(n) += t.J_j.transpose() * t.r;
  chain.border_block += J_B.transpose() * J_B;
  chain.border_gradient += J_B.transpose() * t.r;
}

/// Columns of the border in units in which each weighs one; what is not seen at all keeps its unit.
VectorXd columnScales(const MatrixXd& border_block) {
  return border_block.diagonal().unaryExpr(
      [](double x) { return x > 1e-20 ? 1 / std::sqrt(x) : 1.0; });
}

/// W_i = dx_i / dB of every state.
std::optional<std::vector<MatrixXd>> responses(BlockArrow chain, int threads) {
  const Index n = chain.border();
  const VectorXd scale = columnScales(chain.border_block);
  chain.border_block = scale.asDiagonal() * chain.border_block * scale.asDiagonal();
  // Faults that this motion cannot tell apart get a value all the same: a prior of a thousandth of
  // what each alone would be known by.
  chain.border_block.diagonal().array() += 1e-6;
  chain.border_gradient = scale.cwiseProduct(chain.border_gradient);
  for (ChainBorderRows& rows : chain.to_border)
    rows.leftCols(n) = rows.leftCols(n) * scale.asDiagonal();
  const auto inverse = invertChain(chain, {0, threads});
  if (!inverse) return std::nullopt;
  const MatrixXd to_unscaled =
      inverse->solution.border_information * scale.cwiseInverse().asDiagonal();
  std::vector<MatrixXd> W;
  for (const auto& covariance : inverse->covariance.to_border)
    W.push_back(covariance * to_unscaled);
  return W;
}

void addTo(ScoreBlock& block, const FaultViewTerms& v, const MatrixXd& W) {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> T = v.A_B + v.A_x * W;
  addGram(v, T, block.information, block.gradient);
}

std::optional<ChainCovariance> covarianceOf(const CameraImuProblem& problem,
                                            const std::vector<FaultViewTerms>& views,
                                            const std::vector<LinkTerms>& links, Index border) {
  BlockArrow chain(problem.frameCount(), static_cast<int>(border));
  for (const FaultViewTerms& v : views) addView(v, border, chain);
  for (const LinkTerms& t : links) addLink(t, border, chain);
  auto inverse = invertChain(chain, {0, problem.threads});
  if (!inverse) return std::nullopt;
  return std::move(inverse->covariance);
}

std::vector<ScoreBlock> emptyBlocks(const CameraImuProblem& problem, int size, double block_s) {
  const TimeNs begin = problem.frames.front().t;
  const double span = secondsBetween(begin, problem.frames.back().t);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(span / block_s)));
  const TimeNs length = (problem.frames.back().t - begin) / static_cast<TimeNs>(count) + 1;
  std::vector<ScoreBlock> blocks(count);
  for (std::size_t b = 0; b < count; ++b) {
    blocks[b] = {begin + static_cast<TimeNs>(b) * length, VectorXd::Zero(size),
                 MatrixXd::Zero(size, size)};
  }
  return blocks;
}

}  // namespace

std::optional<EffectiveScores> effectiveScores(const CameraImuProblem& problem,
                                               const CameraImuSolution& solution,
                                               const FaultColumns& columns, double block_s) {
  EffectiveScores out;
  out.sway_hz = swayFrequency(problem, solution);
  const auto views = viewTerms(problem, solution, columns);
  auto links = linkTerms(problem, solution, columns, out.sway_hz);
  if (!links) return std::nullopt;
  const auto S = covarianceOf(problem, views, *links, columns.border.size);
  if (!S) return std::nullopt;
  out.jumps = placeJumps(problem, columns, *S, *links);
  BlockArrow chain(problem.frameCount(), columns.size);
  for (const FaultViewTerms& v : views) addView(v, columns.size, chain);
  for (const LinkTerms& t : *links) addLink(t, columns.size, chain);
  const auto W = responses(std::move(chain), problem.threads);
  if (!W) return std::nullopt;
  out.blocks = emptyBlocks(problem, columns.size, block_s);
  const auto blockOf = [&](std::size_t frame) -> ScoreBlock& {
    const auto next =
        std::upper_bound(out.blocks.begin(), out.blocks.end(), problem.frames[frame].t,
                         [](TimeNs t, const ScoreBlock& block) { return t < block.begin; });
    return *(next - 1);
  };
  for (const FaultViewTerms& v : views) addTo(blockOf(v.frame), v, (*W)[v.frame]);
  for (const LinkTerms& t : *links) {
    const MatrixXd U = t.J_B + t.J_i * (*W)[t.at] + t.J_j * (*W)[t.at + 1];
    ScoreBlock& block = blockOf(t.at);
    block.information += U.transpose() * U;
    block.gradient += U.transpose() * t.r;
  }
  return out;
}

}  // namespace plumbline
