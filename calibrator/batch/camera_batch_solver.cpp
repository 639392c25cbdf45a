// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_batch_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calibrator/base/lie.h"
#include "calibrator/batch/parallel_chunks.h"

namespace plumbline {
namespace {

constexpr int kChunk = 32;  // frames
constexpr double kFirstDamping = 1e-4;
constexpr double kLeastDamping = 1e-12;
constexpr double kMostDamping = 1e10;

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

}  // namespace

CameraSolution solveCameraProblem(const CameraProblem& problem, const CameraEstimate& start,
                                  const CameraSolverOptions& options) {
  CameraSolution now{start, normalsAt(problem, start), false, 0};
  double damping = kFirstDamping;
  while (now.iterations < options.max_iterations && damping < kMostDamping) {
    ++now.iterations;
    const auto step = StepSolver(now.normals, damping, problem.threads).solve();
    if (!step) {
      damping = std::max(10 * damping, 1e-6);
      continue;
    }
    if (settled(step->decrement, now.normals.cost, options)) {
      now.converged = damping < 0.1;
      break;
    }
    CameraEstimate next = moved(now.estimate, *step);
    CameraNormals normals = normalsAt(problem, next);
    if (normals.cost <= now.normals.cost * (1 + 1e-14)) {
      now.estimate = std::move(next);
      now.normals = std::move(normals);
      damping = std::max(0.03 * damping, kLeastDamping);
    } else {
      damping = std::max(10 * damping, 1e-6);
    }
  }
  return now;
}

}  // namespace plumbline
