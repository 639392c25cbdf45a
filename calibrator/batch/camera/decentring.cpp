// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/decentring.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "calibrator/base/camera_models.h"
#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/distributions.h"
#include "calibrator/batch/corners.h"
#include "calibrator/camera/camera.h"
#include "calibrator/information/cluster_robust.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kTerms = 2;                // p1, p2
constexpr double kCentredChance = 1e-4;  // of a lens that is centred, to be called decentred
// Of p, by which corners are displaced to see how the gradient follows: a thousandth of a pixel.
constexpr double kStep = 1e-6;

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

/// A camera by itself.
class LoneCamera {
 public:
  LoneCamera(const CameraProblem& problem, const CameraEstimate& estimate, std::size_t camera)
      : problem_(problem),
        estimate_{{estimate.intrinsics[camera]}, {Transform()}, {}, estimate.target} {
    problem_.corners = problem.corners.subspan(camera, 1);
    problem_.frames.clear();
    problem_.weights.clear();
    problem_.prior = nullptr;
    problem_.threads = 1;
    // Re-weighted: with the loss' own curvature a view's information might be indefinite.
    problem_.gram = {problem.gram.cauchy_px, 0};
    std::vector<std::size_t> seeing;
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      if (problem.frames[f].view[camera] >= 0) seeing.push_back(f);
    }
    const Transform T_CiC0 = estimate.T_C0Ci[camera].inverse();
    const std::size_t stride = std::max<std::size_t>(1, seeing.size() / kMostViews);
    for (std::size_t i = 0; i < seeing.size(); i += stride) {
      const Frame& frame = problem.frames[seeing[i]];
      problem_.frames.push_back({frame.t, {frame.view[camera]}});
      estimate_.T_C0F.push_back(T_CiC0 * estimate.T_C0F[seeing[i]]);
    }
  }

  int views() const { return problem_.frameCount(); }
  Index size() const { return CameraLayout(estimate_).size + kTerms; }

  ViewEquations view(int index) const {
    const int at = problem_.frames[index].view[0];
    const std::vector<PackedCorners> corners{
        problem_.corners[0].thinned({at}, std::numeric_limits<int>::max())};
    const CameraNormals n = normalsOf(index, corners);
    const Index own = n.b.size();
    MatrixXd X(6, own + kTerms), M(own + kTerms, own + kTerms);
    VectorXd b(own + kTerms);
    X.leftCols(own) = n.P;
    M.topLeftCorner(own, own) = n.G;
    b.head(own) = n.b;
    for (int term = 0; term < kTerms; ++term) {
      std::vector<PackedCorners> moved = corners;
      moved[0].displace([&](double u, double v) -> Eigen::Vector2d {
        return kStep * displacement(estimate_.intrinsics[0], u, v).col(term);
      });
      const CameraNormals with = normalsOf(index, moved);
      // e = projected - measured: what is added to the model is taken from the measured.
      X.col(own + term) = (n.b_pose - with.b_pose) / kStep;
      M.col(own + term).head(own) = (n.b - with.b) / kStep;
      M.row(own + term).head(own) = M.col(own + term).head(own).transpose();
    }
    addSquares(corners[0].view(0), index, b.tail<kTerms>(), M);
    const Matrix6d& H = n.H.front();
    const Eigen::LLT<Matrix6d> llt(H);
    if (!isDetermined(H, llt)) {
      return {VectorXd::Zero(b.size()), MatrixXd::Zero(b.size(), b.size()), {}};
    }
    MatrixXd moves = -llt.solve(X);
    return {b + moves.transpose() * n.b_pose, M + X.transpose() * moves, std::move(moves)};
  }

  /// What is known of the board beforehand, in the parameters' order.
  QuadraticCost prior() const {
    QuadraticCost out;
    out.H = MatrixXd::Zero(size(), size());
    out.b = VectorXd::Zero(size());
    if (!estimate_.target) return out;
    const Index at = CameraLayout(estimate_).target;
    out.H.block<kTargetTerms, kTargetTerms>(at, at) = problem_.target->information;
    out.b.segment<kTargetTerms>(at) = problem_.target->priorGradient(*estimate_.target);
    return out;
  }

 private:
  /// Of one view, without the prior.
  CameraNormals normalsOf(int index, const std::vector<PackedCorners>& corners) const {
    CameraProblem one = problem_;
    one.corners = corners;
    one.frames = {{problem_.frames[index].t, {0}}};
    CameraEstimate at = estimate_;
    at.T_C0F = {estimate_.T_C0F[index]};
    CameraNormals n = normalsAt(one, at);
    if (at.target) {
      n.b.tail<kTargetTerms>() -= one.target->priorGradient(*at.target);
      n.G.bottomRightCorner<kTargetTerms, kTargetTerms>() -= one.target->information;
    }
    return n;
  }

  void addSquares(const PackedView& view, int index, Eigen::Ref<VectorXd> gradient,
                  MatrixXd& M) const {
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    gradient.setZero();
    const auto errors = viewErrors(estimate_.intrinsics[0], estimate_.T_C0F[index], view);
    const double variance = problem_.pixel_sigma * problem_.pixel_sigma;
    const double c = problem_.gram.cauchy_px;
    for (int k = 0; k < view.count; ++k) {
      const double loss = c > 0 ? 1 + errors[k].squaredNorm() / (c * c) : 1;
      const double weight = view.w[k] * view.w[k] / (loss * variance);
      const Eigen::Matrix2d D = displacement(estimate_.intrinsics[0], view.u[k], view.v[k]);
      squares += weight * D.transpose() * D;
      gradient -= weight * D.transpose() * errors[k];  // errors: measured - projected
    }
    M.bottomRightCorner<kTerms, kTerms>() = squares;
  }

  CameraProblem problem_;
  CameraEstimate estimate_;
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
  const Eigen::LLT<Eigen::Matrix2d> llt(V);
  if (llt.info() != Eigen::Success) return std::nullopt;
  out.f = (dof - 1) / (kTerms * dof) * out.p.dot(llt.solve(out.p));
  out.limit = fisherTailQuantile(kTerms, dof - 1, kCentredChance);
  // The other parameters follow: their part of the joint covariance over the terms' own.
  const Eigen::Matrix2d own = covariance->bottomRightCorner<kTerms, kTerms>();
  out.turn = zero.turn * (covariance->rightCols<kTerms>() * own.llt().solve(out.p));
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
