// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/cluster_robust.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kUncorrelated = 0.1;  // where the correlation of pieces is taken to end
constexpr double kLengths = 2;         // of it in a block
constexpr int kMostBlocks = 40;        // they know a variance to 22 %
constexpr int kMostUnits = 240;
// What a block alone determines leaves no residual to judge by: the score there is zero but for
// rounding, which is not to be magnified.
constexpr double kLeastRedundancy = 1e-3;

/// (I - G)^(-1/2) of a block's leverage G, eigenvalues from 0 to 1.
MatrixXd adjustment(const MatrixXd& leverage) {
  const SymmetricEigen eigen = symmetricEigen(leverage);
  const VectorXd redundancy = (1 - eigen.values.array()).cwiseMax(kLeastRedundancy).cwiseMin(1);
  return eigen.vectors * redundancy.cwiseSqrt().cwiseInverse().asDiagonal() *
         eigen.vectors.transpose();
}

}  // namespace

ClusterRobust clusterRobust(const BlockScores& blocks, const MatrixXd& covariance) {
  assert(blocks.scores.cols() == static_cast<Index>(blocks.information.size()));
  const Index n = covariance.rows();
  const MatrixXd C = covariance.llt().matrixL();  // whitens: C' H_b C add up to I
  ClusterRobust out;
  MatrixXd half(n, blocks.scores.cols());
  for (const MatrixXd& information : blocks.information) {
    const Index b = out.degrees.leverage.size();
    const MatrixXd G = C.transpose() * information * C;
    out.degrees.leverage.emplace_back(0.5 * (G + G.transpose()));
    out.degrees.adjustment.emplace_back(adjustment(out.degrees.leverage.back()) * C.transpose());
    half.col(b) = out.degrees.adjustment.back() * blocks.scores.col(b);
  }
  // S^-1 u = C (I - G)^(-1/2) C' s, for (I - H S^-1)^(-1/2) = C'^-1 (I - G)^(-1/2) C'.
  const MatrixXd root = C * half;
  out.matrix = root * root.transpose();
  return out;
}

ScorePieces::ScorePieces(Index parameters, int pieces)
    : scores(MatrixXd::Zero(parameters, pieces)),
      information_(std::min(kMostUnits, pieces), MatrixXd::Zero(parameters, parameters)) {}

MatrixXd ScorePieces::totalInformation() const {
  MatrixXd total = MatrixXd::Zero(scores.rows(), scores.rows());
  for (const MatrixXd& unit : information_) total += unit;
  return total;
}

BlockScores ScorePieces::blocks(int count) const {
  BlockScores out{MatrixXd(scores.rows(), count), {}};
  for (int b = 0; b < count; ++b) {
    const int begin = b * units() / count;
    const int end = (b + 1) * units() / count;
    const int first = firstOfUnit(begin);
    out.scores.col(b) = scores.middleCols(first, firstOfUnit(end) - first).rowwise().sum();
    MatrixXd sum = information_[begin];
    for (int u = begin + 1; u < end; ++u) sum += information_[u];
    out.information.push_back(std::move(sum));
  }
  return out;
}

std::optional<RobustCovariance> robustCovarianceOf(const ScorePieces& pieces,
                                                   const MatrixXd& covariance) {
  if (pieces.pieces() < kLeastBlocks) return std::nullopt;
  RobustCovariance out;
  out.correlation_frames = correlationLength(pieces.scores, covariance);
  out.blocks = std::min(kMostBlocks, blocksOf(pieces.pieces(), out.correlation_frames));
  ClusterRobust robust = clusterRobust(pieces.blocks(out.blocks), covariance);
  // What neighbouring blocks share is in no block's own square: the sum is too small by that.
  const double per_block = static_cast<double>(pieces.pieces()) / out.blocks;
  out.matrix = robust.matrix / shareWithin(per_block, out.correlation_frames);
  out.degrees = std::move(robust.degrees);
  return out;
}

double correlationLength(const MatrixXd& scores, const MatrixXd& covariance) {
  // covariance = L L', and L' s has the covariance I where s has that of white noise. No mean is
  // taken off: at an optimum the scores add up to zero.
  const MatrixXd half = covariance.llt().matrixU();
  const MatrixXd white = half * scores;
  const double power = white.squaredNorm();
  if (!(power > 0)) return 1;
  // The integrated autocorrelation: the mean of N such pieces varies as that of N / length
  // independent ones.
  double length = 1;
  const Index pieces = white.cols();
  for (Index k = 1; k <= pieces / kLeastBlocks; ++k) {
    const Index rest = pieces - k;
    const double rho = white.leftCols(rest).cwiseProduct(white.rightCols(rest)).sum() / power;
    if (rho < kUncorrelated) break;
    // Up to there, lest the noise of many small correlations adds up.
    length += 2 * rho;
  }
  return length;
}

int blocksOf(int pieces, double correlation_length) {
  const double per_block = correlation_length > 1 ? kLengths * correlation_length : 1;
  return std::max(std::min(kLeastBlocks, pieces), static_cast<int>(pieces / per_block));
}

double shareWithin(double pieces, double correlation_length) {
  if (!(correlation_length > 1)) return 1;
  // rho(k) = exp(-k / tau) has the length 2 tau. The double integral of rho over a block of n
  // pieces is the variance of their sum, n length (1 - (1 - exp(-x)) / x) with x = n / tau.
  const double x = 2 * pieces / correlation_length;
  return 1 - (1 - std::exp(-x)) / x;
}

}  // namespace plumbline
