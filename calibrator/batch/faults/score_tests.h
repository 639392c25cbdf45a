// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/results.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/batch/faults/fault_columns.h"
#include "calibrator/linear/block_arrow.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {

// Internal to the score tests: whitened rows of views and links by the columns of the batch and of
// every fault.

/// Whitened rows of the link from frame `at` to the next.
struct LinkTerms {
  std::size_t at = 0;
  Eigen::Matrix<double, Eigen::Dynamic, kChainBlock> J_i, J_j;  // 9 (if inertial) + 6 rows
  Eigen::MatrixXd J_B;  ///< by the first FaultColumns::of_links columns
  Eigen::VectorXd r;
};

/// One view in columns of its own: the twist of the target's pose in the camera (6), which states
/// and border move, and its intrinsics, the target's shape and the line delay, each of which is a
/// column of the border. J' J of these, and J' r.
struct FaultViewTerms {
  std::size_t frame = 0;
  Eigen::Matrix<double, 6, Eigen::Dynamic> H;  ///< the twist's rows, all columns
  Eigen::VectorXd H_own;                       ///< the other rows' upper triangle, row by row
  Eigen::VectorXd b;
  Eigen::Matrix<double, 6, kChainBlock> A_x;
  Eigen::Matrix<double, 6, Eigen::Dynamic> A_B;  ///< by the columns `by` of the border
  std::vector<Eigen::Index> by;                  ///< those that move the pose
  std::vector<Eigen::Index> own;                 ///< those that the columns from 6 on are
};

/// Of all views at a solution.
std::vector<FaultViewTerms> viewTerms(const CameraImuProblem& problem,
                                      const CameraImuSolution& solution,
                                      const FaultColumns& columns);

/// Of every link that is not broken, a target that sways at `sway_hz` among the faults; empty where
/// samples do not cover one. The columns of jumps are zero (placeJumps()).
std::optional<std::vector<LinkTerms>> linkTerms(const CameraImuProblem& problem,
                                                const CameraImuSolution& solution,
                                                const FaultColumns& columns, double sway_hz);

/// Instants of the links where a jump explains most, camera clock.
struct JumpPlaces {
  TimeNs gyro_at = 0, accel_at = 0, target_at = 0;
  /// What a displacement of the target explains in one link of twenty, over what it would by
  /// chance: large where every link has residuals of its own.
  double target_dispersion = 1;
};

/// Blocks of about `block_s` seconds from the first frame to the last.
struct TimeBlocks {
  TimeBlocks(const std::vector<Frame>& frames, double block_s);
  std::size_t of(TimeNs t) const { return static_cast<std::size_t>((t - begin) / length); }

  TimeNs begin = 0, length = 0;
  std::size_t count = 0;
};

/// Score and information of a piece of the recording about the border's and the faults' columns,
/// with all states adapting: with J the whitened Jacobian, r the residual, W = dx/dB the response
/// of the states, J~ = J_B + J_x W:   gradient = sum J~' r,   information = sum J~' J~.
struct ScoreBlock {
  TimeNs begin = 0;
  int views = 0;  ///< 0: the target is not seen
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

struct EffectiveScores {
  std::vector<ScoreBlock> blocks;
  double sway_hz = 0;  ///< frequency at which the forces left over in F are largest
  JumpPlaces jumps;
};

/// In TimeBlocks. Empty where the system has no inverse or samples do not cover a window.
std::optional<EffectiveScores> effectiveScores(const CameraImuProblem& problem,
                                               const CameraImuSolution& solution,
                                               const FaultColumns& columns, double block_s);

/// A column of the scores that acts from a block of time on.
struct Term {
  int column = 0;
  std::size_t from = 0;
};
using Terms = std::vector<Term>;

/// The scores about any terms: sums over the blocks in which they act.
class Scores {
 public:
  explicit Scores(std::vector<ScoreBlock> blocks);

  std::size_t count() const { return blocks_.size(); }
  /// Blocks in which the target is seen: the others say nothing, and are no sample of how scores
  /// scatter.
  std::size_t seen() const { return seen_; }
  bool isSeen(std::size_t block) const { return blocks_[block].views > 0; }
  TimeNs begin(std::size_t block) const { return blocks_[block].begin; }

  Eigen::VectorXd gradient(const Terms& terms) const;
  Eigen::MatrixXd information(const Terms& a, const Terms& b) const;
  /// The same of one block.
  Eigen::VectorXd gradient(const Terms& terms, std::size_t block) const;
  Eigen::MatrixXd information(const Terms& a, const Terms& b, std::size_t block) const;

 private:
  std::vector<ScoreBlock> blocks_;
  std::vector<ScoreBlock> tails_;  // sums from a block to the end
  std::size_t seen_ = 0;
};

/// chi2 as a deviate of the normal distribution (Wilson and Hilferty 1931).
double significanceOf(double chi2, int dof);

/// Score tests beside a model: the calibration's parameters, and faults that were accepted.
/// The equations are those of diagnoseFaults().
class ScoreTests {
 public:
  /// The model's first columns are the border's.
  ScoreTests(const Scores& scores, Terms model);

  const Terms& model() const { return model_; }
  /// How far the model's optimum is from the solution, in deviations.
  double offOptimum() const {
    // Rounding may leave less than 0 at an optimum; NaN stays NaN.
    return std::sqrt(std::max(gradient_.dot(S_ * gradient_), 0.0));
  }
  /// Deviations of T_SC0 (3 m, 3 rad) and the time offset [s]: robust ones by the blocks as they
  /// are, of which the tests are made. As the calibration's they are too small on short recordings;
  /// see clusterRobustDeviations().
  Eigen::Matrix<double, 7, 1> robustStd() const;
  Eigen::Matrix<double, 7, 1> formalStd() const;
  /// Those of combinations of the model's parameters, a row each: adjusted for the leverage of
  /// every block, blocks that see the target joined where neighbours correlate
  /// (calibrator/information/cluster_robust.h). Degrees of freedom are those of the joined blocks.
  RobustDeviations clusterRobustDeviations(const Eigen::MatrixXd& combinations) const;

  /// How the model follows parameters that are held, a column for each.
  Eigen::MatrixXd response(const Terms& held) const;

  /// Beyond `range` in any component no estimate is believed. Where that is so, directions that the
  /// motion does not determine (a deviation above a tenth of the range) are held at 0, and the
  /// others are tested: `dof` counts these, and std is NaN of components that are not in them. The
  /// directions are eigenvectors of the information, so that no estimate depends on those held.
  /// Components have one unit where the range is finite. Where no direction is determined, or none
  /// is not, all are tested.
  FaultTest test(const Terms& fault, double range = std::numeric_limits<double>::infinity()) const;

  /// By how much the calibration's robust variances exceed the formal ones, in the mean of logs.
  double overdispersion() const;

 private:
  /// One block's score with the model at its estimate.
  Eigen::VectorXd scoreAtEstimate(std::size_t block) const;
  /// Sum of s s' over blocks of the fault's scores, with fault and model at their estimates, of
  /// which the fault's have `dof` degrees of freedom.
  Eigen::MatrixXd scatter(const Terms& fault, const Eigen::MatrixXd& P,
                          const Eigen::VectorXd& estimate, int dof) const;

  const Scores& scores_;
  const Terms model_;
  const Eigen::MatrixXd S_;
  const Eigen::VectorXd gradient_;
  Eigen::VectorXd robust_variance_;
};

}  // namespace plumbline
