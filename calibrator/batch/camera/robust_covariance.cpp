// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/robust_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "calibrator/base/parallel.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

constexpr int kBlocks = 40;  // they know a variance to 22 %
constexpr int kLeastBlocks = 6;
constexpr double kUncorrelated = 0.1;  // where the correlation of frames is taken to end
constexpr double kLengths = 2;         // of it in a block
constexpr int kChunk = 16;             // frames

/// Gradient of one frame's cost in cameras and terms, its pose eliminated, without priors.
Eigen::VectorXd frameScore(const CameraProblem& one, const CameraEstimate& at) {
  const CameraNormals n = normalsAt(one, at);
  Eigen::VectorXd score = n.b;
  if (at.target) score.tail<kTargetTerms>() -= one.target->priorGradient(*at.target);
  const Eigen::LLT<Matrix6d> llt(n.H.front());
  if (llt.info() == Eigen::Success) score -= n.P.transpose() * llt.solve(n.b_pose);
  return score;
}

/// A column per frame.
Eigen::MatrixXd frameScores(const CameraProblem& problem, const CameraEstimate& estimate) {
  const int frames = problem.frameCount();
  Eigen::MatrixXd scores(CameraLayout(estimate).size, frames);
  forChunks(frames, kChunk, problem.threads, [&](const Chunk& chunk) {
    CameraProblem one = problem;
    one.threads = 1;
    one.prior = nullptr;
    CameraEstimate at = estimate;
    for (int f = chunk.begin; f < chunk.end; ++f) {
      one.frames = {problem.frames[static_cast<std::size_t>(f)]};
      one.weights = {problem.weight(f)};
      at.T_C0F = {estimate.T_C0F[static_cast<std::size_t>(f)]};
      scores.col(f) = frameScore(one, at);
    }
  });
  return scores;
}

/// Frames over which scores err together: 1 + 2 sum rho(k), rho the correlation of whitened scores
/// k frames apart, up to where it ends.
double correlationLength(const Eigen::MatrixXd& scores, const Eigen::MatrixXd& covariance) {
  const Eigen::MatrixXd half = covariance.llt().matrixU();
  const Eigen::MatrixXd white = half * scores;
  const double power = white.squaredNorm();
  if (!(power > 0)) return 1;
  double length = 1;
  const auto frames = white.cols();
  for (Eigen::Index k = 1; k < frames / kLeastBlocks; ++k) {
    const auto rest = frames - k;
    const double rho = white.leftCols(rest).cwiseProduct(white.rightCols(rest)).sum() / power;
    if (rho < kUncorrelated) break;
    length += 2 * rho;
  }
  return length;
}

/// The variance of sums over blocks of `frames` frames as a share of what it would be if blocks did
/// not correlate with each other, for a correlation that falls exponentially with the time constant
/// length / 2: 1 - (1 - exp(-x)) / x, x = frames / time constant.
double shareWithin(double frames, double length) {
  if (!(length > 1)) return 1;
  const double x = 2 * frames / length;
  return 1 - (1 - std::exp(-x)) / x;
}

}  // namespace

std::optional<RobustCovariance> robustCovariance(const CameraProblem& problem,
                                                 const CameraSolution& solution) {
  const int frames = problem.frameCount();
  const auto bread = covarianceOf(reducedInformation(solution.normals));
  if (frames < kLeastBlocks || !bread) return std::nullopt;
  const Eigen::MatrixXd scores = frameScores(problem, solution.estimate);
  RobustCovariance out;
  out.correlation_frames = correlationLength(scores, *bread);
  const double per_block = out.correlation_frames > 1 ? kLengths * out.correlation_frames : 1;
  out.blocks = std::min(kBlocks, static_cast<int>(frames / per_block));
  Eigen::MatrixXd sums(bread->rows(), out.blocks);
  for (int b = 0; b < out.blocks; ++b) {
    const int first = b * frames / out.blocks;
    sums.col(b) = scores.middleCols(first, (b + 1) * frames / out.blocks - first).rowwise().sum();
  }
  const Eigen::MatrixXd half = *bread * sums;
  const double share =
      shareWithin(static_cast<double>(frames) / out.blocks, out.correlation_frames);
  out.matrix = half * half.transpose() * (out.blocks / (out.blocks - 1.0) / share);
  if (solution.estimate.target) {
    const Eigen::MatrixXd gain = bread->rightCols<kTargetTerms>();
    out.matrix += gain * problem.target->scatter * gain.transpose();
  }
  return out;
}

}  // namespace plumbline
