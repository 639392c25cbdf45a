// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/camera_window.h"

#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

/// Nothing is known of n parameters.
QuadraticCost nothingOf(int n) {
  return {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0};
}

/// Pose of a single frame, then cameras.
QuadraticCost joint(const CameraNormals& normals) {
  assert(normals.H.size() == 1);
  const Eigen::Index n = normals.b.size();
  QuadraticCost cost{Eigen::MatrixXd(6 + n, 6 + n), Eigen::VectorXd(6 + n), normals.cost};
  // H of the pose, P pose by cameras, G of the cameras, as CameraNormals has them.
  cost.H << normals.H[0], normals.P, normals.P.transpose(), normals.G;
  cost.b << normals.b_pose, normals.b;
  return cost;
}

}  // namespace

Displacement displacementOf(const CameraEstimate& to, const CameraEstimate& from) {
  // Intrinsics and translations add, so that only rotations have a derivative other than 1.
  const CameraLayout layout(from);
  Displacement out{cameraDifference(to, from), Eigen::MatrixXd::Identity(layout.size, layout.size)};
  for (std::size_t c = 1; c < from.intrinsics.size(); ++c) {
    // Log(Exp(da) R_to R_from^T) = d + Jl^-1(d) da.
    const int e = layout.T_C0Ci[c] + 3;
    out.J.block<3, 3>(e, e) = inverseLeftJacobianSO3(out.d.segment<3>(e));
  }
  return out;
}

void CameraWindowOptions::check() const {
  MeasurementModel::check();
  requireAtLeast(1, "size", size);
  requireAtLeast(1, "max_iterations", max_iterations);
  requirePositive("tolerance", tolerance);
}

CameraWindow::CameraWindow(const AprilGrid& target, const std::vector<CameraCalibration>& cameras,
                           const CameraWindowOptions& options)
    : target_(target),
      given_(cameras),
      options_(options),
      estimate_(estimateOf(cameras)),
      views_(cameras.size()),
      corners_(cameras.size()),
      prior_{nothingOf(CameraLayout(estimate_.intrinsics).size), estimate_} {
  options.check();
}

void CameraWindow::add(const std::vector<std::vector<Corner>>& corners, const Transform& T_FC0) {
  assert(corners.size() == views_.size());
  // Without stamps: a frame is known by its place.
  for (std::size_t c = 0; c < views_.size(); ++c) views_[c].push_back({0, corners[c]});
  estimate_.T_C0F.push_back(T_FC0.inverse());
  pack();
}

bool CameraWindow::solve() {
  CameraSolution solution = solveCameraProblem(
      problem(allFrames()), estimate_,
      {.max_iterations = options_.max_iterations, .tolerance = options_.tolerance});
  if (!solution.converged) return false;
  estimate_ = std::move(solution.estimate);
  return true;
}

void CameraWindow::marginaliseOldest() {
  assert(frameCount() > 0);
  // The problem of the oldest frame alone has the prior in it: with the frame's pose eliminated,
  // what is left of both is the new prior. A frame that leaves its own pose free has nothing to
  // leave.
  CameraEstimate at = estimate_;
  at.T_C0F.resize(1);
  const CameraNormals normals = normalsAt(problem({allFrames().front()}), at);
  std::vector<int> cameras(normals.b.size());
  std::iota(cameras.begin(), cameras.end(), 6);
  auto rest = marginalised(joint(normals), cameras);
  if (rest) {
    at.T_C0F.clear();
    prior_ = {std::move(*rest), std::move(at)};
  }
  remove(0);
}

void CameraWindow::remove(int frame) {
  assert(frame >= 0 && frame < frameCount());
  // Views, poses and packed corners share one index, the frame's place in the window.
  for (std::vector<ImageView>& views : views_) views.erase(views.begin() + frame);
  estimate_.T_C0F.erase(estimate_.T_C0F.begin() + frame);
  pack();
}

std::vector<CameraCalibration> CameraWindow::cameras() const {
  std::vector<CameraCalibration> cameras = given_;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    cameras[c].intrinsics = estimate_.intrinsics[c];
    cameras[c].T_C0Ci = estimate_.T_C0Ci[c];
    // Deviations of what was given say nothing of the values here.
    cameras[c].intrinsics_std.reset();
    cameras[c].T_C0Ci_std.reset();
  }
  return cameras;
}

Eigen::MatrixXd CameraWindow::information() const {
  return reducedInformation(normalsAt(problem(allFrames()), estimate_));
}

std::optional<double> CameraWindow::rmsePx() const {
  double squared = 0;
  int count = 0;
  for (std::size_t c = 0; c < corners_.size(); ++c) {
    const Transform T_CiC0 = estimate_.T_C0Ci[c].inverse();
    for (int f = 0; f < frameCount(); ++f) {
      const PackedView view = corners_[c].view(f);
      if (view.count == 0) continue;
      const Transform T_CiF = T_CiC0 * estimate_.T_C0F[f];
      // Without the loss, as every RMSE is.
      squared += viewCost(estimate_.intrinsics[c], T_CiF, view);
      count += view.count;
    }
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(squared / count);
}

CameraProblem CameraWindow::problem(std::vector<Frame> frames) const {
  CameraProblem problem;
  problem.corners = corners_;
  problem.frames = std::move(frames);
  problem.pixel_sigma = options_.pixel_sigma;
  // 0: a frame leaves by re-weighted squares, whose information is never negative; near the minimum
  // the solver adds the loss' curvature by itself.
  problem.gram = {options_.cauchy_px, 0};
  problem.prior = [this](const CameraEstimate& at) { return priorAt(at); };
  return problem;
}

std::vector<Frame> CameraWindow::allFrames() const {
  std::vector<Frame> frames(frameCount());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (const std::vector<ImageView>& views : views_) {
      frames[f].view.push_back(views[f].corners.empty() ? -1 : static_cast<int>(f));
    }
  }
  return frames;
}

void CameraWindow::pack() {
  for (std::size_t c = 0; c < views_.size(); ++c) corners_[c] = PackedCorners(target_, views_[c]);
}

}  // namespace plumbline
