// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/batch/camera_imu/effective_terms.h"
#include "calibrator/linear/block_arrow.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using PoseRows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Adds U' H U and U' b of a view, the first six rows of U being T and the others unit vectors of
/// its own columns; only the first T.cols() columns of the border.
void addViewGram(const FaultViewTerms& v, const PoseRows& T, MatrixXd& information,
                 VectorXd& gradient) {
  const Index n = T.cols();
  information.noalias() += T.transpose() * (v.H.leftCols<6>() * T).eval();
  gradient.noalias() += T.transpose() * v.b.head<6>();
  const double* H_own = v.H_own.data();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    const Index row = 6 + static_cast<Index>(i);
    const Index column = v.own[i];
    if (column < n) {
      const VectorXd cross = T.transpose() * v.H.col(row);
      information.col(column) += cross;
      information.row(column) += cross.transpose();
      gradient(column) += v.b(row);
    }
    for (std::size_t j = i; j < v.own.size(); ++j, ++H_own) {
      // H_own goes on for columns that are left out, too: it is one list.
      if (column >= n || v.own[j] >= n) continue;
      information(column, v.own[j]) += *H_own;
      if (j > i) information(v.own[j], column) += *H_own;
    }
  }
}

/// T += A_B, in its first T.cols() columns.
void addByBorder(const FaultViewTerms& v, PoseRows& T) {
  for (std::size_t k = 0; k < v.by.size(); ++k) {
    if (v.by[k] < T.cols()) T.col(v.by[k]) += v.A_B.col(k);
  }
}

/// The chain's own blocks and its coupling to the first n columns of the border.
void addView(const FaultViewTerms& v, Index n, BlockArrow& chain) {
  const Eigen::Matrix<double, kChainBlock, 6> AxH = v.A_x.transpose() * v.H.leftCols<6>();
  chain.diagonal[v.frame] += AxH * v.A_x;
  ChainBorderRows& rows = chain.to_border[v.frame];
  for (std::size_t k = 0; k < v.by.size(); ++k) {
    if (v.by[k] < n) rows.col(v.by[k]) += AxH * v.A_B.col(k);
  }
  rows.col(n) += v.A_x.transpose() * v.b.head<6>();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    if (v.own[i] >= n) continue;
    rows.col(v.own[i]) += v.A_x.transpose() * v.H.col(6 + i);
  }
}

void addLink(const LinkTerms& t, Index n, BlockArrow& chain) {
  // Columns from of_links on are zero in every link, and not stored.
  const Index touched = std::min(n, t.J_B.cols());
  const auto J_B = t.J_B.leftCols(touched);
  chain.diagonal[t.at] += t.J_i.transpose() * t.J_i;
  chain.next[t.at] += t.J_i.transpose() * t.J_j;
  chain.diagonal[t.at + 1] += t.J_j.transpose() * t.J_j;
  chain.to_border[t.at].leftCols(touched) += t.J_i.transpose() * J_B;
  chain.to_border[t.at].col(n) += t.J_i.transpose() * t.r;
  chain.to_border[t.at + 1].leftCols(touched) += t.J_j.transpose() * J_B;
  chain.to_border[t.at + 1].col(n) += t.J_j.transpose() * t.r;
}

/// With the first n columns of the border, whose own block stays zero.
BlockArrow chainOf(const CameraImuProblem& problem, const std::vector<FaultViewTerms>& views,
                   const std::vector<LinkTerms>& links, Index n) {
  BlockArrow chain(problem.frameCount(), static_cast<int>(n));
  for (const FaultViewTerms& v : views) addView(v, n, chain);
  for (const LinkTerms& t : links) addLink(t, n, chain);
  return chain;
}

// At the optimum of the batch, with its own columns alone: what the residuals' redundancy is judged
// by.
std::optional<ChainCovariance> covarianceOf(const CameraImuProblem& problem,
                                            const std::vector<FaultViewTerms>& views,
                                            const std::vector<LinkTerms>& links, Index border) {
  BlockArrow chain = chainOf(problem, views, links, border);
  for (const FaultViewTerms& v : views) {
    PoseRows T = PoseRows::Zero(6, border);
    addByBorder(v, T);
    addViewGram(v, T, chain.border_block, chain.border_gradient);
  }
  for (const LinkTerms& t : links) {
    const auto J_B = t.J_B.leftCols(border);
    chain.border_block += J_B.transpose() * J_B;
    chain.border_gradient += J_B.transpose() * t.r;
  }
  auto inverse = invertChain(chain, {0, problem.threads});
  if (!inverse) return std::nullopt;
  return std::move(inverse->covariance);
}

void addTo(ScoreBlock& block, const FaultViewTerms& v, const ChainResponse& W) {
  PoseRows T = v.A_x * W;
  addByBorder(v, T);
  addViewGram(v, T, block.information, block.gradient);
}

void addTo(ScoreBlock& block, const LinkTerms& t, const std::vector<ChainResponse>& W) {
  // J~ = J_B + J_i W_i + J_j W_j.
  MatrixXd U = t.J_i * W[t.at] + t.J_j * W[t.at + 1];
  U.leftCols(t.J_B.cols()) += t.J_B;
  block.information.noalias() += U.transpose() * U;
  block.gradient.noalias() += U.transpose() * t.r;
}

std::vector<ScoreBlock> emptyBlocks(const CameraImuProblem& problem, int size, double block_s) {
  const TimeNs begin = problem.frames.front().t;
  const double span = secondsBetween(begin, problem.frames.back().t);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(span / block_s)));
  // One nanosecond more than the share, so that the last frame falls into the last block.
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
  // Before the scores: where a jump is tested decides what its column is.
  if (const auto S = covarianceOf(problem, views, *links, columns.border.size)) {
    out.jumps = placeJumps(problem, columns, *S, *links);
  } else {
    return std::nullopt;
  }
  // Now with all columns, jumps included; the border's own information comes from the blocks.
  const auto W = chainResponses(chainOf(problem, views, *links, columns.size), problem.threads);
  if (!W) return std::nullopt;
  out.blocks = emptyBlocks(problem, columns.size, block_s);
  const auto blockOf = [&](std::size_t frame) -> ScoreBlock& {
    const auto next =
        std::upper_bound(out.blocks.begin(), out.blocks.end(), problem.frames[frame].t,
                         [](TimeNs t, const ScoreBlock& block) { return t < block.begin; });
    return *(next - 1);
  };
  for (const FaultViewTerms& v : views) addTo(blockOf(v.frame), v, (*W)[v.frame]);
  for (const LinkTerms& t : *links) addTo(blockOf(t.at), t, *W);
  return out;
}

}  // namespace plumbline
