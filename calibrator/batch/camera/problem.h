// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/transform.h"
#include "calibrator/linear/dense.h"
#include "calibrator/linear/levenberg_marquardt.h"
#include "calibrator/residuals/packed_corners.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {

/// All unknowns. Poses are kept as T_C0F, so that camera 0's derivatives need no chain.
struct CameraEstimate {
  std::vector<Intrinsics> intrinsics;
  std::vector<Transform> T_C0Ci;  ///< identity for camera 0
  std::vector<Transform> T_C0F;   ///< one per frame
  /// The board's terms [m] where they are estimated; otherwise the corners hold its shape.
  std::optional<TargetTerms> target;
};

/// The cameras as given, and a frame for each pose.
CameraEstimate estimateOf(const std::vector<CameraCalibration>& cameras,
                          std::span<const Transform> T_FC0 = {});

/// Derivatives of the twist of T_CiF = T_C0Ci^-1 T_C0F; the same in every frame.
struct CameraDerivatives {
  Transform T_CiC0;
  Matrix6d A_pose;    ///< in the left twist of T_C0F: the adjoint of T_CiC0
  Eigen::Matrix3d A;  ///< in the tangent of T_C0Ci: diag(A, A), A = -R_CiC0
};
std::vector<CameraDerivatives> derivativesOf(const CameraEstimate& estimate);  ///< per camera

/// Priors of a board's higher terms, in the units of the cost: each is `mean` with this
/// information, and the gradient of that has the covariance `scatter` (both diagonal). Of a known
/// board they are given; otherwise the mean is zero, and the variances are estimated with the
/// terms.
struct HigherPrior {
  bool given = false;    ///< of the polynomials; remainders' variances are always estimated
  Eigen::VectorXd mean;  ///< [m]; of kHigherTerms, or of these and the remainders
  Eigen::VectorXd information;
  Eigen::VectorXd scatter;
};

/// What of the board is estimated beside the twelve terms: nothing; its HigherTerms; these and the
/// remainders of single corners.
enum class BoardDetail { kTwelve, kHigher, kCorners };

/// A board whose shape is estimated: about its grid, with what is known of the terms beforehand.
/// The grid's higher terms hold while the others are solved for (higher_terms.h).
struct TargetModel {
  /// Nothing is known: every term is 0 +- prior_std.
  explicit TargetModel(const AprilGrid& board) : grid(board), basis(board) {}
  AprilGrid grid;
  TargetBasis basis;
  /// [m]; weak, so that a recording that says nothing of a term leaves the system regular. 0.5 mm
  /// and more change no estimate of EuRoC's board.
  static constexpr double prior_std = 5e-3;
  /// The prior's part of the cost is 0.5 (terms - mean)' information (terms - mean).
  TargetTerms mean = TargetTerms::Zero();
  TargetCovariance information = TargetCovariance::Identity() / (prior_std * prior_std);
  /// Covariance of the prior's gradient, its mean being in error: what the sandwich adds. The weak
  /// prior's is negligible.
  TargetCovariance scatter = TargetCovariance::Zero();
  std::optional<HigherPrior> higher;  ///< where they are estimated from this recording

  TargetTerms priorGradient(const TargetTerms& terms) const { return information * (terms - mean); }
};

/// Frames that one task of a parallel loop takes; fixed, so that no result depends on the threads.
inline constexpr int kFrameChunk = 32;

/// All measurements of the camera batch. The corners are shared between problems (a first solution
/// on some views, then all of them); who makes the problem keeps them alive.
struct CameraProblem {
  std::span<const PackedCorners> corners;  ///< per camera, all views of the session
  std::vector<Frame> frames;
  std::vector<double> weights;  ///< how often a frame counts; empty: each once
  double pixel_sigma = 1;       ///< [px]
  GramOptions gram{0, 0};       ///< of which the solver chooses triggs_clamp by itself
  int threads = 1;
  /// Amplitude of an error that all views share, over their RMS error (robustCovariance()).
  double common_error_share = 0;
  /// The board whose terms the estimate has.
  std::shared_ptr<const TargetModel> target;
  /// What is known of the cameras besides, in units of pixel_sigma: a cost about the estimate's
  /// cameras, in their tangents and the layout's order. Empty: nothing.
  std::function<QuadraticCost(const CameraEstimate&)> prior;

  int frameCount() const { return static_cast<int>(frames.size()); }
  double weight(int frame) const { return weights.empty() ? 1.0 : weights[frame]; }
};

/// The board's own terms: all but tag_edge, the last, which is the recording's and its detector's.
inline constexpr int kBoardTerms = kTargetTerms - 1;

/// Where each parameter of the cameras stands: intrinsics of all cameras, then all extrinsics, then
/// the board's terms.
struct CameraLayout {
  std::vector<int> intrinsics;       ///< per camera, first of stacked()
  std::vector<int> intrinsics_size;  ///< per camera
  std::vector<int> T_C0Ci;           ///< per camera, first of 6; -1 for camera 0
  int target = -1;                   ///< first of kTargetTerms; -1: not estimated
  int size = 0;

  explicit CameraLayout(const std::vector<Intrinsics>& cameras);
  explicit CameraLayout(const CameraEstimate& estimate);
  int camerasSize() const { return target < 0 ? size : target; }  ///< of the cameras alone
};

/// What leads from one estimate to another of the same cameras, in the order of CameraLayout(from):
/// differences of stacked(), boxminus of T_C0Ci, differences of the board's terms. `to` has terms
/// where `from` has.
Eigen::VectorXd cameraDifference(const CameraEstimate& to, const CameraEstimate& from);

/// Normal equations at an estimate, in units of pixel_sigma: with d_f the left twist (rho, phi) of
/// T_C0F in frame f and g the cameras' parameters (tangents of Transform),
///   [H_f  P_f; P_f^T  G] [d_f; g] = -[b_f; b].
struct CameraNormals {
  std::vector<Matrix6d> H;  ///< per frame
  Eigen::MatrixXd P;        ///< 6 rows per frame
  Eigen::VectorXd b_pose;   ///< 6 per frame
  Eigen::MatrixXd G;
  Eigen::VectorXd b;
  double cost = 0;  ///< 0.5 sum rho(|e|^2) / pixel_sigma^2, weighted by the frames' weights;
                    ///< and the prior's, which is also in G and b
};
CameraNormals normalsAt(const CameraProblem& problem, const CameraEstimate& estimate);
/// The same with another weighting of the corners.
CameraNormals normalsAt(const CameraProblem& problem, const CameraEstimate& estimate,
                        const GramOptions& gram);

/// Whether a pose's H is positive definite beyond rounding: H scaled to a unit diagonal has no
/// pivot below 1e-12.
bool isDetermined(const Matrix6d& H, const Eigen::LLT<Matrix6d>& llt);

/// R with R^T R = H^-1 of a frame's pose, or the pseudo-inverse where corners leave a part of the
/// pose free (not isDetermined(), or an eigenvalue below 1e-12): such a frame says what holds
/// whatever that part is, and one or two corners of one camera say nothing.
class PoseElimination {
 public:
  explicit PoseElimination(const Matrix6d& H);
  /// R P of P with 6 rows.
  Eigen::MatrixXd operator*(const Eigen::Ref<const Eigen::MatrixXd>& P) const;

 private:
  Eigen::LLT<Matrix6d> llt_;
  std::optional<Matrix6d> R_;  ///< where a part is free
};

/// What all frames together say of the cameras, their poses eliminated:
/// S = G - sum_f P_f^T H_f^-1 P_f, by PoseElimination.
Eigen::MatrixXd reducedInformation(const CameraNormals& normals);

/// The share of every frame in it, which add up to S less the prior.
std::vector<Eigen::MatrixXd> frameInformation(const CameraProblem& problem,
                                              const CameraEstimate& estimate);

struct CameraSolution {
  CameraEstimate estimate;
  CameraNormals normals;  ///< at the estimate, weighted as problem.gram says
  bool converged = false;
  int iterations = 0;  ///< steps tried
};

/// Levenberg-Marquardt on the structured normal equations: every frame's pose is eliminated where
/// the frame stands, and the cameras' parameters are a small dense system.
///
/// With a loss the first steps re-weight (GramOptions::triggs_clamp as given); near the minimum the
/// loss' whole second derivative takes part, without which convergence is slow.
CameraSolution solveCameraProblem(const CameraProblem& problem, const CameraEstimate& start,
                                  const MinimiserOptions& options = {});

}  // namespace plumbline
