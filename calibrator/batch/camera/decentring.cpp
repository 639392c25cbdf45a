// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/decentring.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrator/base/camera_models.h"
#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/distributions.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/information/cluster_robust.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kTerms = 2;                // p1, p2
constexpr double kCentredChance = 1e-4;  // of a lens that is centred, to be called decentred
// Up to twice as many take part: neighbours show nearly the same.
constexpr std::size_t kMostViews = 400;

/// Conrady's displacement by p1 = 1 and by p2 = 1 [px].
Eigen::Matrix2d displacement(const Intrinsics& camera, double u, double v) {
  const double s = pixelsPerRadian(camera);
  const double x = (u - camera.projection.tail<2>()[0]) / s;
  const double y = (v - camera.projection.tail<2>()[1]) / s;
  Eigen::Matrix2d out;
  out.col(0) << 2 * x * y, x * x + 3 * y * y;
  out.col(1) << 3 * x * x + y * y, 2 * x * y;
  return s * out;
}

/// One view in the camera's parameters, the board's terms where it is estimated, p1 and p2:
/// gradient and information with the pose eliminated, and how the pose follows.
struct ViewEquations {
  VectorXd score;
  MatrixXd information;
  MatrixXd moves;  ///< of the pose's left twist by the parameters; empty: the pose is free
};

/// A camera by itself: every n-th of its views, with the target's pose in it.
class LoneCamera {
 public:
  LoneCamera(const CameraProblem& problem, const CameraEstimate& estimate, std::size_t camera)
      : problem_(problem),
        estimate_(estimate),
        lens_(estimate.intrinsics[camera]),
        corners_(problem.corners[camera]) {
    if (estimate.target) basis_ = &problem.target->basis;
    std::vector<std::size_t> seeing;
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      if (problem.frames[f].view[camera] >= 0) seeing.push_back(f);
    }
    const Transform T_CiC0 = estimate.T_C0Ci[camera].inverse();
    const std::size_t stride = std::max<std::size_t>(1, seeing.size() / kMostViews);
    for (std::size_t i = 0; i < seeing.size(); i += stride) {
      views_.push_back(
          {problem.frames[seeing[i]].view[camera], T_CiC0 * estimate.T_C0F[seeing[i]]});
    }
  }

  int views() const { return static_cast<int>(views_.size()); }
  Index size() const { return target() + (basis_ != nullptr ? kTargetTerms : 0) + kTerms; }

  ViewEquations view(int index) const {
    const QuadraticCost of = equationsOf(views_[index]);
    const MatrixXd& H = of.H;
    const Eigen::LLT<Matrix6d> llt(H.topLeftCorner<6, 6>());
    if (!isDetermined(H.topLeftCorner<6, 6>(), llt)) {
      return {VectorXd::Zero(size()), MatrixXd::Zero(size(), size()), {}};
    }
    const MatrixXd X = H.topRightCorner(6, size());
    MatrixXd moves = -llt.solve(X);
    return {of.b.tail(size()) + moves.transpose() * of.b.head<6>(),
            H.bottomRightCorner(size(), size()) + X.transpose() * moves, std::move(moves)};
  }

  /// What is known of the board beforehand, in the parameters' order.
  QuadraticCost prior() const {
    QuadraticCost out;
    out.H = MatrixXd::Zero(size(), size());
    out.b = VectorXd::Zero(size());
    if (basis_ == nullptr) return out;
    out.H.block<kTargetTerms, kTargetTerms>(target(), target()) = problem_.target->information;
    out.b.segment<kTargetTerms>(target()) = problem_.target->priorGradient(*estimate_.target);
    return out;
  }

 private:
  struct SeenView {
    int view = 0;
    Transform T_CF;
  };

  Index target() const { return lens_.stacked().size(); }

  /// Normal equations in the pose's twist and the parameters, re-weighted: all with the weights
  /// that the loss gives the residuals, for what poses leave of the terms is a small difference.
  QuadraticCost equationsOf(const SeenView& seen) const {
    const PackedView view = corners_.view(seen.view);
    const double c2 = problem_.gram.cauchy_px * problem_.gram.cauchy_px;
    MatrixXd J = MatrixXd::Zero(2 * view.count, 6 + size());
    VectorXd r = VectorXd::Zero(2 * view.count);
    for (int i = 0; i < view.count; ++i) {
      if (!(view.w[i] > 0)) continue;
      const Eigen::Vector3d p = seen.T_CF * Eigen::Vector3d(view.x[i], view.y[i], view.z[i]);
      const auto image = projectBeyondFold(lens_, p);
      if (!image) continue;
      const Eigen::Vector2d error = image->uv - Eigen::Vector2d(view.u[i], view.v[i]);
      const double w =
          view.w[i] / problem_.pixel_sigma / std::sqrt(c2 > 0 ? 1 + error.squaredNorm() / c2 : 1.0);
      auto rows = J.middleRows<2>(2 * i);
      rows.leftCols<3>() = w * image->J_point;
      rows.middleCols<3>(3) = -w * image->J_point * skew(p);
      rows.middleCols(6, target()) = w * image->J_intrinsics;
      if (basis_ != nullptr) {
        Eigen::Matrix<double, 3, kTargetTerms> B = basis_->columns(view.id[i]);
        B.col(kTargetTerms - 1) *= view.edge[i];  // tag_edge, by how large the tag looks
        rows.middleCols<kTargetTerms>(6 + target()) = w * image->J_point * seen.T_CF.R * B;
      }
      rows.rightCols<kTerms>() = w * displacement(lens_, view.u[i], view.v[i]);
      r.segment<2>(2 * i) = w * error;
    }
    return {J.transpose() * J, J.transpose() * r};
  }

  const CameraProblem& problem_;
  const CameraEstimate& estimate_;
  const Intrinsics& lens_;
  const PackedCorners& corners_;
  const TargetBasis* basis_ = nullptr;  ///< where the board's terms are estimated
  std::vector<SeenView> views_;
};

/// All views' sums, at `step` from the solution, and the mean turn of their poses.
struct CameraTerms {
  ScorePieces pieces;
  Eigen::Matrix3Xd turn;
};
CameraTerms termsOf(const LoneCamera& camera, int threads, const VectorXd& step) {
  CameraTerms out{ScorePieces(camera.size(), camera.views()),
                  Eigen::Matrix3Xd::Zero(3, camera.size())};
  std::vector<Eigen::Matrix3Xd> turns(out.pieces.units(), out.turn);
  parallelCalls(out.pieces.units(), threads, [&](int u) {
    for (int i = out.pieces.firstOfUnit(u); i < out.pieces.firstOfUnit(u + 1); ++i) {
      const ViewEquations view = camera.view(i);
      out.pieces.scores.col(i) = view.score + view.information * step;
      out.pieces.information(u) += view.information;
      if (view.moves.size() > 0) turns[u] += view.moves.bottomRows<3>();
    }
  });
  for (const Eigen::Matrix3Xd& turn : turns) out.turn += turn / camera.views();
  return out;
}

/// One step from where the terms are zero, and Hotelling's test of them.
std::optional<Decentring> testOf(const LoneCamera& camera, int threads) {
  const CameraTerms zero = termsOf(camera, threads, VectorXd::Zero(camera.size()));
  const QuadraticCost prior = camera.prior();
  const auto covariance = covarianceOf(zero.pieces.totalInformation() + prior.H);
  if (!covariance) return std::nullopt;
  const VectorXd step = -*covariance * (zero.pieces.scores.rowwise().sum() + prior.b);
  // Scores where the step ends: at its start those of a decentred lens have it in each of them.
  const auto robust = robustCovarianceOf(termsOf(camera, threads, step).pieces, *covariance);
  if (!robust) return std::nullopt;
  Decentring out;
  out.p = step.tail<kTerms>();
  const RobustDeviations deviations = robust->deviations(camera.size());
  out.std = deviations.std.tail<kTerms>();
  const double dof = deviations.dof.tail<kTerms>().minCoeff();
  if (!(dof > kTerms)) return std::nullopt;
  // (dof - 1) / (2 dof) T^2 is Fisher's F with 2 and dof - 1 degrees of freedom.
  const Eigen::Matrix2d V = robust->matrix.bottomRightCorner<kTerms, kTerms>();
  const SymmetricFactor factor(V);
  if (!factor.isPositiveDefinite()) return std::nullopt;
  out.f = (dof - 1) / (kTerms * dof) * factor.squaredNorm(out.p);
  out.limit = fisherTailQuantile(kTerms, dof - 1, kCentredChance);
  // The other parameters follow: their part of the joint covariance over the terms' own.
  const Eigen::Matrix2d own = covariance->bottomRightCorner<kTerms, kTerms>();
  out.turn = zero.turn * (covariance->rightCols<kTerms>() * SymmetricFactor(own).solve(out.p));
  return out;
}

}  // namespace

std::vector<Decentring> testDecentring(const CameraProblem& problem, const CameraEstimate& estimate,
                                       const std::vector<CameraCalibration>& cameras) {
  std::vector<Decentring> tests;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (hasTangentialTerms(estimate.intrinsics[c].distortion_model)) continue;
    const LoneCamera camera(problem, estimate, c);
    if (camera.views() < kLeastBlocks) continue;
    auto test = testOf(camera, problem.threads);
    if (!test) continue;
    test->camera = cameras[c].name;
    tests.push_back(std::move(*test));
  }
  return tests;
}

}  // namespace plumbline
