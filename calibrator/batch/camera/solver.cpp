// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrator/base/lie.h"
#include "calibrator/base/parallel.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {
namespace {

constexpr int kChunk = 32;  // frames
constexpr double kFirstDamping = 1e-4;
constexpr double kLeastDamping = 1e-12;
constexpr double kMostDamping = 1e10;
constexpr double kFaithfulDamping = 1e-2;  // up to here a short step means a minimum
constexpr double kEase = 0.03;             // of the damping, where all goes well
constexpr double kRounding = 1e-11;        // share of the cost below which its change tells nothing
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

class StepSolver {
 public:
  StepSolver(const CameraNormals& normals, double damping, int threads)
      : n_(normals), damping_(damping), threads_(threads) {}

  std::optional<Step> solve() {
    const int frames = static_cast<int>(n_.H.size());
    L_.resize(n_.H.size());
    W_ = n_.P;
    y_ = n_.b_pose;
    std::vector<Eliminated> parts(static_cast<std::size_t>(chunkCount(frames, kChunk)));
    forChunks(frames, kChunk, threads_, [&](const Chunk& chunk) {
      parts[static_cast<std::size_t>(chunk.index)] = eliminate(chunk);
    });
    Eigen::MatrixXd S = n_.G;
    S.diagonal() *= 1 + damping_;
    Eigen::VectorXd s = n_.b;
    for (const Eliminated& part : parts) {
      if (!part.positive) return std::nullopt;
      S -= part.WtW;
      s -= part.Wty;
    }
    const Eigen::LLT<Eigen::MatrixXd> llt(S);
    if (llt.info() != Eigen::Success) return std::nullopt;
    Step step;
    step.cameras = -llt.solve(s);
    step.poses = -(y_ + W_ * step.cameras);
    for (int f = 0; f < frames; ++f) {
      auto x = step.poses.segment<6>(6 * f);
      L_[static_cast<std::size_t>(f)].transpose().triangularView<Eigen::Upper>().solveInPlace(x);
    }
    if (!step.cameras.allFinite() || !step.poses.allFinite()) return std::nullopt;
    step.decrement = -(step.cameras.dot(n_.b) + step.poses.dot(n_.b_pose));
    return step;
  }

 private:
  Eliminated eliminate(const Chunk& chunk) {
    Eliminated out;
    for (int f = chunk.begin; f < chunk.end; ++f) {
      Matrix6d A = n_.H[static_cast<std::size_t>(f)];
      A.diagonal() *= 1 + damping_;
      const Eigen::LLT<Matrix6d> llt(A);
      if (llt.info() != Eigen::Success) out.positive = false;
      Matrix6d& L = L_[static_cast<std::size_t>(f)];
      L = llt.matrixL();
      auto W = W_.middleRows<6>(6 * f);
      L.triangularView<Eigen::Lower>().solveInPlace(W);
      auto y = y_.segment<6>(6 * f);
      L.triangularView<Eigen::Lower>().solveInPlace(y);
    }
    const int rows = 6 * (chunk.end - chunk.begin);
    const auto W = W_.middleRows(6 * chunk.begin, rows);
    out.WtW = W.transpose() * W;
    out.Wty = W.transpose() * y_.segment(6 * chunk.begin, rows);
    return out;
  }

  const CameraNormals& n_;
  double damping_;
  int threads_;
  std::vector<Matrix6d> L_;
  Eigen::MatrixXd W_;
  Eigen::VectorXd y_;
};

/// T after the left twist (rho, phi), to first order p' = p + rho + phi x p; orthonormal.
Transform twisted(const Transform& T, const Vector6d& x) {
  const Eigen::Matrix3d turn = expSO3(x.tail<3>());
  const Eigen::Quaterniond q(turn * T.R);
  return {q, turn * T.t + x.head<3>()};
}

CameraEstimate moved(const CameraEstimate& from, const Step& step) {
  CameraEstimate to = from;
  const CameraLayout layout(from.intrinsics);
  for (std::size_t c = 0; c < to.intrinsics.size(); ++c) {
    const int first = layout.intrinsics[c];
    const int size = layout.intrinsics_size[c];
    to.intrinsics[c].setStacked(from.intrinsics[c].stacked() + step.cameras.segment(first, size));
    if (c > 0) {
      to.T_C0Ci[c] = boxplus(from.T_C0Ci[c], step.cameras.segment<6>(layout.T_C0Ci[c]));
    }
  }
  for (std::size_t f = 0; f < to.T_C0F.size(); ++f) {
    to.T_C0F[f] = twisted(from.T_C0F[f], step.poses.segment<6>(6 * static_cast<Eigen::Index>(f)));
  }
  return to;
}

/// The step is below the tolerance, or below what rounding of the cost can tell.
bool settled(double decrement, double cost, const CameraSolverOptions& options) {
  return decrement <= options.tolerance * options.tolerance ||
         decrement <= options.cost_tolerance * cost;
}

/// Levenberg and Marquardt's loop: damping, and with a loss how much of its curvature is used.
class Minimiser {
 public:
  Minimiser(const CameraProblem& problem, const CameraEstimate& start,
            const CameraSolverOptions& options)
      : problem_(problem), options_(options), gram_(problem.gram) {
    now_.estimate = start;
    now_.normals = normalsAt(problem_, start, gram_);
  }

  CameraSolution run() {
    while (now_.iterations < options_.max_iterations && damping_ < kMostDamping) {
      ++now_.iterations;
      if (!iterate()) break;
    }
    if (gram_.triggs_clamp != problem_.gram.triggs_clamp) {
      now_.normals = normalsAt(problem_, now_.estimate);
    }
    return std::move(now_);
  }

 private:
  /// One step; false where none remains.
  bool iterate() {
    const auto step = StepSolver(now_.normals, damping_, problem_.threads).solve();
    if (!step) {
      refuse();
      return true;
    }
    if (settled(step->decrement, now_.normals.cost, options_)) {
      now_.converged = damping_ < kFaithfulDamping;
      damping_ *= kEase;
      return !now_.converged;
    }
    CameraEstimate next = moved(now_.estimate, *step);
    const bool near = step->decrement < kNear * now_.normals.cost;
    const GramOptions gram = near ? newton() : gram_;
    CameraNormals normals = normalsAt(problem_, next, gram);
    if (normals.cost <= now_.normals.cost * (1 + 1e-14)) {
      damping_ = std::max(dampingAfter(*step, now_.normals.cost, normals.cost), kLeastDamping);
      gram_ = gram;
      --steps_until_curvature_;
      now_.estimate = std::move(next);
      now_.normals = std::move(normals);
    } else {
      refuse();
    }
    return true;
  }

  /// Less where the cost fell as promised, more where it fell by less than half of that (after
  /// Nielsen, "Damping parameter in Marquardt's method", 1999). Where rounding hides the cost's
  /// fall, more if the steps do not shrink.
  double dampingAfter(const Step& step, double before, double after) {
    const double last = std::exchange(last_decrement_, step.decrement);
    if (step.decrement < kRounding * before) {
      return step.decrement < 0.3 * last ? damping_ : 10 * std::max(damping_, 1e-9);
    }
    const double gain = (before - after) / (0.5 * step.decrement);
    const double factor = 1 - std::pow(2 * gain - 1, 3);
    if (factor > 1) return 2 * factor * std::max(damping_, 1e-8);
    return std::max(kEase, factor) * damping_;
  }

  /// The whole second derivative of the loss.
  GramOptions newton() const {
    GramOptions gram = problem_.gram;
    if (gram.cauchy_px > 0 && steps_until_curvature_ <= 0) gram.triggs_clamp = 2;
    return gram;
  }

  /// After a step that did not help: more damping, or back to re-weighting for a while.
  void refuse() {
    if (gram_.triggs_clamp != problem_.gram.triggs_clamp) {
      steps_until_curvature_ = patience_;
      patience_ *= 2;
      gram_ = problem_.gram;
      now_.normals = normalsAt(problem_, now_.estimate, gram_);
      return;
    }
    damping_ = std::max(10 * damping_, 1e-6);
  }

  const CameraProblem& problem_;
  const CameraSolverOptions& options_;
  GramOptions gram_;
  CameraSolution now_;
  double damping_ = kFirstDamping;
  int steps_until_curvature_ = 0;
  int patience_ = 4;
  double last_decrement_ = 0;
};

}  // namespace

CameraSolution solveCameraProblem(const CameraProblem& problem, const CameraEstimate& start,
                                  const CameraSolverOptions& options) {
  return Minimiser(problem, start, options).run();
}

}  // namespace plumbline
