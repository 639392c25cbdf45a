// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera_imu/effective_terms.h"

namespace plumbline {

/// A column of the scores that acts from a block of time on.
struct Term {
  int column = 0;
  std::size_t from = 0;
};
using Terms = std::vector<Term>;

/// Columns first to first + count - 1.
Terms termRange(int first, int count, std::size_t from = 0);

/// The scores about any terms: sums over the blocks in which they act.
class Scores {
 public:
  explicit Scores(std::vector<ScoreBlock> blocks);

  std::size_t count() const { return blocks_.size(); }
  TimeNs begin(std::size_t block) const { return blocks_[block].begin; }

  Eigen::VectorXd gradient(const Terms& terms) const;
  Eigen::MatrixXd information(const Terms& a, const Terms& b) const;
  /// The same of one block.
  Eigen::VectorXd gradient(const Terms& terms, std::size_t block) const;
  Eigen::MatrixXd information(const Terms& a, const Terms& b, std::size_t block) const;

 private:
  std::vector<ScoreBlock> blocks_;
  std::vector<ScoreBlock> tails_;  // sums from a block to the end
};

/// chi2 as a deviate of the normal distribution (Wilson and Hilferty 1931).
double significanceOf(double chi2, int dof);

/// The significance that by chance is exceeded as seldom as `deviations` (above 0) of a normal
/// deviate are, where the dispersion is estimated from so many blocks of time (at least 2):
///   chi2 / dof follows F(dof, 3 (blocks - 1)).
/// The variances of T_SC0's translation, its rotation and the time offset count as three estimates
/// of the dispersion (ScoreTests::overdispersion()). `deviations` at least, which it approaches for
/// many blocks.
double significanceBound(double deviations, int dof, std::size_t blocks);

/// Score tests beside a model: the calibration's parameters, and faults that were accepted.
/// The equations are those of diagnoseFaults().
class ScoreTests {
 public:
  /// The model's first columns are the border's.
  ScoreTests(const Scores& scores, Terms model);

  const Terms& model() const { return model_; }
  /// Deviations of T_SC0 (3 m, 3 rad) and the time offset [s]: robust ones by the blocks as they
  /// are, of which the tests are made. As the calibration's they are too small on short recordings;
  /// see clusterRobustDeviations().
  Eigen::Matrix<double, 7, 1> robustStd() const;
  Eigen::Matrix<double, 7, 1> formalStd() const;
  /// Those of the calibration: adjusted for the leverage of every block, blocks joined where
  /// neighbours correlate (calibrator/information/covariance.h). Degrees of freedom are those
  /// of the joined blocks.
  RobustDeviations clusterRobustDeviations() const;

  /// How T_SC0 and the time offset follow parameters that are held: 7 rows, a column for each.
  Eigen::MatrixXd response(const Terms& held) const;

  FaultTest test(const Terms& fault) const;

  /// By how much the calibration's robust variances exceed the formal ones, in the mean of logs.
  double overdispersion() const;

 private:
  /// One block's score with the model at its estimate.
  Eigen::VectorXd scoreAtEstimate(std::size_t block) const;
  /// Sum of s s' over blocks of the fault's scores, with fault and model at their estimates.
  Eigen::MatrixXd scatter(const Terms& fault, const Eigen::MatrixXd& P,
                          const Eigen::VectorXd& estimate) const;

  const Scores& scores_;
  const Terms model_;
  const Eigen::MatrixXd S_;
  const Eigen::VectorXd gradient_;
  Eigen::VectorXd robust_variance_;
};

}  // namespace plumbline
