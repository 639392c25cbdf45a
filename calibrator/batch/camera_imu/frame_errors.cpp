// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {

FrameErrors frameErrors(const CameraImuProblem& problem, const CameraImuEstimate& estimate) {
  constexpr int kDelay = MovedView::kDelay;
  // Re-weighted, as all else that is said of the optimum.
  const GramOptions gram{problem.gram.cauchy_px, 0};
  FrameErrors out;
  // (free: sum of b' H^-1 b, along: sum of b_d^2 / H_dd.)
  double squares = 0, corners = 0, free = 0, along = 0, weight = 0, products = 0, before = 0;
  for (std::size_t i = 0; i < problem.frames.size(); ++i) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    double H_d = 0, b_d = 0;
    for (std::size_t c = 0; c < problem.corners.size(); ++c) {
      if (problem.frames[i].view[c] < 0) continue;
      const MovedView view = movedView(problem, estimate, gram, {i, c});
      H += view.H.topLeftCorner<6, 6>();
      b += view.b.head<6>();
      H_d += view.H(kDelay, kDelay);
      b_d += view.b(kDelay);
      squares += view.squared_error;
      corners += problem.corners[c].view(problem.frames[i].view[c]).used();
    }
    // Twice what the cost falls by with the pose free, and below with its stamp alone free.
    free += b.dot(H.ldlt().solve(b));
    const double taken = H_d > 0 ? b_d / std::sqrt(H_d) : 0;
    along += taken * taken;
    weight += H_d;
    products += taken * before;
    before = taken;
  }
  const auto n = static_cast<double>(problem.frames.size());
  if (!(corners > 0 && weight > 0 && along > 0)) return out;
  out.rmse_px = std::sqrt(squares / corners);
  out.free_rmse_px = std::sqrt(std::max(0.0, squares - free) / corners);
  out.along = along / n;
  // What noise takes along any one direction.
  out.across = (free - along) / (5 * n);
  out.neighbours = products / along;
  // A shift of d seconds takes H_dd d^2 beyond that.
  out.jitter_s = std::sqrt(std::max(0.0, along - n * out.across) / weight);
  return out;
}

}  // namespace plumbline
