// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

/// What blocks of measurements say of n parameters at an estimate, everything else eliminated.
struct BlockScores {
  Eigen::MatrixXd scores;                    ///< n x M: gradients of the blocks' costs
  std::vector<Eigen::MatrixXd> information;  ///< M of n x n: their shares H_b of the information
};

struct ClusterRobust {
  Eigen::MatrixXd matrix;  ///< n x n
  /// Of its variances: an interval is the deviation times a quantile of Student's t with as many
  /// degrees of freedom (halfWidth90()).
  ClusterDegrees degrees;
};

/// Cluster-robust ("sandwich") covariance of an estimate with `covariance` S^-1 = (sum H_b)^-1:
///   S^-1 (sum_b u_b u_b^T) S^-1,   u_b = (I - H_b S^-1)^(-1/2) s_b.
/// A block's residuals are smaller than its errors, since it took part in the estimate: its score
/// has the covariance H_b - H_b S^-1 H_b under white noise, and u_b has H_b, so that the result is
/// S^-1 in the mean, however few and unlike the blocks are (CR2: Bell and McCaffrey 2002;
/// Pustejovsky and Tipton 2018, in the parameters' space). A factor M / (M - 1) makes up for that
/// only where all blocks say equally much. `degrees` are those of the same white noise, of the
/// blocks as they are given.
/// Units may differ between parameters. `covariance` is positive definite.
ClusterRobust clusterRobust(const BlockScores& blocks, const Eigen::MatrixXd& covariance);

/// What consecutive pieces of time (frames) say of n parameters, everything else eliminated.
class ScorePieces {
 public:
  /// Of so many parameters and pieces; all say nothing yet.
  ScorePieces(Eigen::Index parameters, int pieces);

  /// n x pieces: gradients of the pieces' costs.
  Eigen::MatrixXd scores;

  int pieces() const { return static_cast<int>(scores.cols()); }
  /// Information is kept in runs of neighbouring pieces: at most 240, six or more to a block, so
  /// that any number of blocks cuts the recording about evenly, and no matrix is kept per piece.
  int units() const { return static_cast<int>(information_.size()); }
  int firstOfUnit(int unit) const { return unit * pieces() / units(); }
  /// n x n: the share of a unit's pieces in the information.
  Eigen::MatrixXd& information(int unit) { return information_[unit]; }

  Eigen::MatrixXd totalInformation() const;
  /// Blocks each of whole units and of about as many.
  BlockScores blocks(int count) const;

 private:
  std::vector<Eigen::MatrixXd> information_;
};

/// clusterRobust() of pieces in blocks of two correlation lengths of their scores, 40 at most, over
/// shareWithin(). `covariance` as there. Empty of fewer than kLeastBlocks pieces.
std::optional<RobustCovariance> robustCovarianceOf(const ScorePieces& pieces,
                                                   const Eigen::MatrixXd& covariance);

/// Pieces of time (frames, seconds) over which scores err together: 1 + 2 sum rho(k), rho the
/// correlation of whitened scores (a column a piece) k pieces apart, up to where it ends, or a
/// sixth of the pieces.
double correlationLength(const Eigen::MatrixXd& scores, const Eigen::MatrixXd& covariance);

/// How many blocks to make of as many pieces: of two correlation lengths each (of one piece where
/// they do not correlate), but six of them at least, or as many as there are pieces.
int blocksOf(int pieces, double correlation_length);

/// The variance of sums over blocks of `pieces` as a share of what it would be if blocks did not
/// correlate with each other, for a correlation that falls exponentially with the time constant
/// length / 2: 1 - (1 - exp(-x)) / x, x = pieces / time constant. 1 where length <= 1. A variance
/// divided by it keeps the degrees of freedom of the blocks.
double shareWithin(double pieces, double correlation_length);

/// Fewer blocks than this say nothing.
inline constexpr int kLeastBlocks = 6;

}  // namespace plumbline
