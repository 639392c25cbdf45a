// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <optional>

#include "calibrator/base/april_grid.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// Of corners, at least: without noise the prior would vanish, and with it what bounds remainders
/// that no view determines.
inline constexpr double kLeastNoisePx = 1e-4;

/// Displacements of a board's single corners, 3 n numbers, that are no similarity and none of its
/// terms (TargetBasis, HigherBasis): the orthogonal complement of those over the corners, in the
/// plane and in height. Its basis are the last columns of the Q of their QR decompositions; a
/// remainder is given by its coordinates there [m], those in the plane first. So the terms keep
/// their meaning beside it, and scale and place of the board their own.
class RemainderSpace {
 public:
  static constexpr int kMostCoordinates = 800;  // a board of 8 x 8 tags has 722
  explicit RemainderSpace(const AprilGrid& board);

  int plane() const { return static_cast<int>(plane_.rows() - plane_.rank()); }
  int height() const { return static_cast<int>(height_.rows() - height_.rank()); }
  int size() const { return plane() + height(); }
  /// Whether there are remainders in the plane and in height, and not more than the dense systems
  /// of their estimation are meant for, which cost the cube of size().
  bool isUsable() const { return plane() > 0 && height() > 0 && size() <= kMostCoordinates; }

  /// Products with x, y of corner 0, of corner 1, ..., then with all heights (3 n rows) become
  /// those with the coordinates (size() rows).
  Eigen::MatrixXd reduced(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;

  /// x, y, height of corner 0, of corner 1, ... from coordinates, and back.
  Eigen::VectorXd corners(const Eigen::VectorXd& coordinates) const;
  Eigen::VectorXd coordinates(const Eigen::VectorXd& corners) const;

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> plane_, height_;
};

/// Normal equations of all parameters together about an estimate, the poses eliminated, in units of
/// pixel_sigma: g the cameras and the twelve terms in the layout's order with what is known of them
/// beforehand, h the higher terms without their prior. S is the information, s the gradient.
struct JointSystem {
  Eigen::MatrixXd S_gg, S_gh, S_hh;
  Eigen::VectorXd s_g;
  Eigen::MatrixXd scores;  ///< s_h of every frame
};
/// Of a problem whose estimate has the board's terms.
JointSystem jointSystem(const CameraProblem& problem, const CameraEstimate& estimate,
                        BoardDetail detail);

/// Of a board under estimation to that detail; none where it has no remainders.
std::optional<RemainderSpace> remainderSpaceOf(const AprilGrid& board, BoardDetail detail);

/// What the board's shape has beside the twelve terms of TargetBasis: terms of degrees 3 and 4
/// (HigherBasis), and with BoardDetail::kCorners the remainders of single corners behind them, as
/// coordinates in the space that a similarity and all terms leave. They have a prior: what a known
/// board's file says, or 0 with one variance each for the cubic and quartic displacements and the
/// remainders, in the plane and in height, estimated with them (largest evidence, MacKay 1992). The
/// solver of the batch does not know them: they are solved for between its solutions, from the
/// normal equations of all parameters together with the poses eliminated, and hold in its board.

/// The solution with them, from one with those of the problem's board (none: zero); `problem`
/// receives a board that has them. Of problems whose estimate has the board's terms. At most
/// `rounds` steps: the first leaves a tenth of a standard deviation, enough where solutions are
/// only compared.
struct HigherSteps {
  BoardDetail detail = BoardDetail::kHigher;
  int rounds = 3;
};
CameraSolution withHigherTerms(CameraProblem& problem, CameraSolution without,
                               const MinimiserOptions& solver, const HigherSteps& steps);

/// The higher terms h where evidence is largest, of a cost 0.5 h^T H h - linear^T h (their prior
/// left out) in units in which the measurements' variance is `noise`; polynomials under the prior
/// where that is given.
struct HigherKnowledge {
  double noise = 1;
  std::optional<HigherPrior> prior = {};
  int remainders_in_plane = 0;  ///< behind the polynomials; what follows are those in height
};
struct HigherPosterior {
  Eigen::VectorXd mean;
  Eigen::VectorXd std;
  HigherPrior prior;
};
HigherPosterior higherPosterior(const Eigen::MatrixXd& H, const Eigen::VectorXd& linear,
                                const HigherKnowledge& known);

/// What the higher terms' uncertainty adds to that of cameras and twelve terms, to first order.
/// With g those parameters, h the higher terms, S_gg and S_gh of the reduced information,
///   K = S_gg^-1 S_gh,   V = (S_hh + prior - S_hg K)^-1:
/// the covariance of g is S_gg^-1 + K V K^T, and its gradient in a frame becomes
///   s_g - S_gh V (s_h - K^T s_g).
struct HigherShare {
  Eigen::MatrixXd S_gh;
  Eigen::MatrixXd K;
  Eigen::MatrixXd V;
  Eigen::MatrixXd scores;      ///< s_h, a column per frame
  Eigen::MatrixXd covariance;  ///< K V K^T
  Eigen::MatrixXd known;       ///< K V scatter V K^T: by the prior's error

  /// Standard deviations of the polynomials [m], `noise` being the corners' variance in units of
  /// pixel_sigma^2.
  HigherTerms deviations(double noise) const;
  /// `scores` of g, a column per frame, with h at its best.
  Eigen::MatrixXd eliminatedFrom(const Eigen::MatrixXd& scores_g) const;
  /// Information of g, with h marginalised instead of fixed.
  Eigen::MatrixXd marginalised(const Eigen::MatrixXd& information) const;
};

/// Empty where the problem's board has no higher terms of its own, or they leave g undetermined.
std::optional<HigherShare> higherShare(const CameraProblem& problem,
                                       const CameraEstimate& estimate);

}  // namespace plumbline
