// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {
namespace {

constexpr double kNear = 1e-3;  // share of the cost that a step takes away near the minimum

struct Step {
  Eigen::VectorXd cameras;
  Eigen::VectorXd poses;  // 6 per frame
  double decrement = 0;   // -step^T gradient = b^T (H + damping)^-1 b
};

/// H = L L^T, W = L^-1 P and y = L^-1 b of the frames of a chunk, and what they take off the
/// cameras' system.
struct Eliminated {
  Eigen::MatrixXd WtW;
  Eigen::VectorXd Wty;
  bool positive = true;
};

/// Solves for one step after another, in memory that it keeps.
class StepSolver {
 public:
  explicit StepSolver(int threads) : threads_(threads) {}

  std::optional<Step> solve(const CameraNormals& n, double damping) {
    const int frames = static_cast<int>(n.H.size());
    L_.resize(n.H.size());
    W_ = n.P;
    y_ = n.b_pose;
    std::vector<Eliminated> parts(chunkCount(frames, kFrameChunk));
    forChunks(frames, kFrameChunk, threads_,
              [&](const Chunk& chunk) { parts[chunk.index] = eliminate(n, damping, chunk); });
    // Marquardt's scaling, here and in eliminate(): damping by shares of the diagonal needs no
    // common unit of pixels, metres and coefficients.
    Eigen::MatrixXd S = n.G;
    S.diagonal() *= 1 + damping;
    Eigen::VectorXd s = n.b;
    for (const Eliminated& part : parts) {
      if (!part.positive) return std::nullopt;
      S -= part.WtW;
      s -= part.Wty;
    }
    const Eigen::LLT<Eigen::MatrixXd> llt(S);
    if (llt.info() != Eigen::Success) return std::nullopt;
    Step step;
    // S x = -s, S = G - P^T H^-1 P and s = b - P^T H^-1 b_f; then H x_f = -(b_f + P x) of every
    // frame, by L^-1 P and L^-1 b_f.
    step.cameras = -llt.solve(s);
    step.poses = -(y_ + W_ * step.cameras);
    for (int f = 0; f < frames; ++f) {
      auto x = step.poses.segment<6>(6 * f);
      L_[f].transpose().triangularView<Eigen::Upper>().solveInPlace(x);
    }
    if (!step.cameras.allFinite() || !step.poses.allFinite()) return std::nullopt;
    step.decrement = -(step.cameras.dot(n.b) + step.poses.dot(n.b_pose));
    return step;
  }

 private:
  Eliminated eliminate(const CameraNormals& n, double damping, const Chunk& chunk) {
    Eliminated out;
    for (int f = chunk.begin; f < chunk.end; ++f) {
      Matrix6d A = n.H[f];
      A.diagonal() *= 1 + damping;
      const Eigen::LLT<Matrix6d> llt(A);
      if (llt.info() != Eigen::Success) out.positive = false;
      Matrix6d& L = L_[f];
      L = llt.matrixL();
      auto W = W_.middleRows<6>(6 * f);
      for (Eigen::Index j = 0; j < W.cols(); ++j) {  // unrolled, as a whole block would not be
        Vector6d column = W.col(j);
        L.triangularView<Eigen::Lower>().solveInPlace(column);
        W.col(j) = column;
      }
      auto y = y_.segment<6>(6 * f);
      L.triangularView<Eigen::Lower>().solveInPlace(y);
    }
    const int rows = 6 * (chunk.end - chunk.begin);
    const auto W = W_.middleRows(6 * chunk.begin, rows);
    // One product over the frames of the chunk: of single frames six rows each would cost more.
    out.WtW = W.transpose() * W;
    out.Wty = W.transpose() * y_.segment(6 * chunk.begin, rows);
    return out;
  }

  int threads_;
  std::vector<Matrix6d> L_;
  Eigen::MatrixXd W_;
  Eigen::VectorXd y_;
};

CameraEstimate moved(const CameraEstimate& from, const Step& step) {
  CameraEstimate to = from;
  const CameraLayout layout(from);
  for (std::size_t c = 0; c < to.intrinsics.size(); ++c) {
    const int first = layout.intrinsics[c];
    const int size = layout.intrinsics_size[c];
    to.intrinsics[c].setStacked(from.intrinsics[c].stacked() + step.cameras.segment(first, size));
    if (c > 0) to.T_C0Ci[c] = boxplus(from.T_C0Ci[c], step.cameras.segment<6>(layout.T_C0Ci[c]));
  }
  if (to.target) *to.target += step.cameras.segment<kTargetTerms>(layout.target);
  for (std::size_t f = 0; f < to.T_C0F.size(); ++f) {
    to.T_C0F[f] = twisted(from.T_C0F[f], step.poses.segment<6>(6 * f));
  }
  return to;
}

/// The camera batch as minimise() wants it. With a loss it chooses how much of the loss' curvature
/// the normal equations have: from afar they re-weight, which never loses definiteness; near the
/// minimum, where a step takes away little, the whole second derivative takes part, without which
/// convergence is linear (GramOptions::triggs_clamp). Where that leads nowhere, it goes back to
/// re-weighting for some steps, twice as many every time.
class Steps {
 public:
  Steps(const CameraProblem& problem, const CameraEstimate& start)
      : problem_(problem), solver_(problem.threads), gram_(problem.gram), estimate_(start) {
    normals_ = normalsAt(problem_, start, gram_);
  }

  double cost() const { return normals_.cost; }

  std::optional<double> solve(double damping) {
    step_ = solver_.solve(normals_, damping);
    if (!step_) return std::nullopt;
    return step_->decrement;
  }

  Trial attempt() {
    next_ = moved(estimate_, *step_);
    // Of the next equations alone: the cost is the same under either, so that the trial is judged
    // fairly.
    const bool near = step_->decrement < kNear * normals_.cost;
    next_gram_ = near ? newton() : gram_;
    next_normals_ = normalsAt(problem_, next_, next_gram_);
    return {.cost = next_normals_.cost};
  }

  void accept() {
    gram_ = next_gram_;
    --steps_until_curvature_;
    std::swap(estimate_, next_);
    std::swap(normals_, next_normals_);
  }

  bool refuse() {
    // It re-weights already: more damping is all that is left.
    if (gram_.triggs_clamp == problem_.gram.triggs_clamp) return false;
    steps_until_curvature_ = patience_;
    patience_ *= 2;
    gram_ = problem_.gram;
    normals_ = normalsAt(problem_, estimate_, gram_);
    return true;
  }

  // The equations that are handed on are those of re-weighting: as information they are never
  // indefinite, as the loss' own curvature may be.
  CameraSolution solution(const MinimiserSummary& summary) && {
    if (gram_.triggs_clamp != problem_.gram.triggs_clamp) normals_ = normalsAt(problem_, estimate_);
    return {std::move(estimate_), std::move(normals_), summary.converged(), summary.iterations};
  }

 private:
  GramOptions newton() const {
    GramOptions gram = problem_.gram;
    // 2: the whole second derivative of the loss; without a loss there is no more of it.
    if (gram.cauchy_px > 0 && steps_until_curvature_ <= 0) gram.triggs_clamp = 2;
    return gram;
  }

  const CameraProblem& problem_;
  StepSolver solver_;
  GramOptions gram_, next_gram_;
  CameraEstimate estimate_, next_;
  CameraNormals normals_, next_normals_;
  std::optional<Step> step_;
  int steps_until_curvature_ = 0;
  int patience_ = 4;
};

}  // namespace

CameraSolution solveCameraProblem(const CameraProblem& problem, const CameraEstimate& start,
                                  const MinimiserOptions& options) {
  Steps steps(problem, start);
  const MinimiserSummary summary = minimise(steps, options);
  return std::move(steps).solution(summary);
}

}  // namespace plumbline
