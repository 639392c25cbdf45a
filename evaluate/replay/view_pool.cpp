// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/view_pool.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/frames.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"
#include "calibrator/information/covariance.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

constexpr double kBorder = 0.1;          // of the image's width and height
constexpr double kPoseTolerance = 1e-5;  // standard deviations of a pose
constexpr int kPoseIterations = 50;

bool isNearBorder(double u, double v, const Resolution& image) {
  // Pixel (0, 0) is the centre of the first one, so the image begins at -0.5.
  const double x = (u + 0.5) / image.width;
  const double y = (v + 0.5) / image.height;
  return std::min({x, y, 1 - x, 1 - y}) < kBorder;
}

/// Positions of `some` (an ascending subset) in `all`, by the views they hold: no two frames share
/// one.
std::vector<int> positionsOf(const std::vector<Frame>& some, const std::vector<Frame>& all) {
  std::vector<int> positions;
  std::size_t at = 0;
  for (const Frame& frame : some) {
    while (all[at].view != frame.view) ++at;
    positions.push_back(static_cast<int>(at++));
  }
  return positions;
}

/// Those frames that are also in `usable` (both ascending).
std::vector<int> among(const std::vector<int>& frames, const std::vector<int>& usable) {
  std::vector<int> both;
  std::set_intersection(frames.begin(), frames.end(), usable.begin(), usable.end(),
                        std::back_inserter(both));
  return both;
}

/// Sums over corners.
struct ErrorSum {
  double squares = 0;
  double count = 0;
  void add(double square) {
    squares += square;
    ++count;
  }
  double rms() const { return count > 0 ? std::sqrt(squares / count) : 0; }
};

/// c^2 log(1 + s / c^2), or s without a loss.
double rho(double squared_px, double cauchy_px) {
  if (cauchy_px == 0) return squared_px;
  const double c2 = cauchy_px * cauchy_px;
  return c2 * std::log1p(squared_px / c2);
}

HeldOutError summaryOf(const std::vector<ViewPool::ImageError>& errors, double cauchy_px) {
  ErrorSum all, border, centre, loss;
  for (const ViewPool::ImageError& e : errors) {
    all.add(e.squared_px);
    (e.is_border ? border : centre).add(e.squared_px);
    loss.add(rho(e.squared_px, cauchy_px));
  }
  return {all.rms(), border.rms(), centre.rms(), loss.rms(),
          all.count > 0 ? border.count / all.count : 0};
}

Failure noFrames(const char* part) { return {FailureCode::kNoFrameOfPart, {{"part", part}}}; }

}  // namespace

Result<ViewPool> ViewPool::prepare(const Session& session, const FrameSplit& split,
                                   const CameraStageOptions& asked, int max_held_out) {
  ViewPool pool;
  pool.session_ = &session;
  pool.options_ = asked;
  // The strategies select, from all frames.
  pool.options_.select_views.reset();
  const auto all = calibrateCameras(session, pool.options_);
  if (!all) return all.failure();
  // From here on selections start from the reference.
  pool.options_.start.clear();
  pool.options_.threads = 1;  // selections run beside each other
  pool.corners_ = usedCorners(session, all->frames, all->residuals);
  pool.frames_ = pairFrames(session.cameras, pool.options_.frames);
  pool.T_C0F_.resize(pool.frames_.size());
  const std::vector<int> usable = positionsOf(all->frames, pool.frames_);
  for (std::size_t i = 0; i < usable.size(); ++i) {
    pool.T_C0F_[usable[i]] = all->T_FC0[i].inverse();
  }
  pool.split_ = {among(split.pool, usable), thinned(among(split.held_out, usable), max_held_out)};
  if (pool.split_.pool.empty()) return noFrames("pool");
  if (pool.split_.held_out.empty()) return noFrames("held-out blocks");
  // The start of the next line's batch, which takes its place.
  pool.reference_.estimate = estimateOf(all->cameras);
  auto reference = pool.solve(pool.split_.pool);
  if (!reference) return Failure{FailureCode::kPoolUnobservable};
  pool.reference_ = std::move(*reference);
  return pool;
}

CameraProblem ViewPool::problemOf(const std::vector<int>& frames) const {
  CameraProblem problem;
  problem.corners = corners_;
  problem.frames = itemsAt(frames_, frames);
  problem.pixel_sigma = options_.pixel_sigma;
  problem.gram.cauchy_px = options_.cauchy_px;
  return problem;
}

std::optional<ViewSolution> ViewPool::solve(std::vector<int> frames) const {
  std::ranges::sort(frames);
  const CameraProblem problem = problemOf(frames);
  // Every selection in the minimum of the reference: what differs is the frames and not how a first
  // guess went.
  CameraEstimate start = reference_.estimate;
  start.T_C0F = itemsAt(T_C0F_, frames);
  MinimiserOptions solver;
  solver.max_iterations = options_.max_iterations;
  solver.tolerance = options_.tolerance;
  CameraSolution solution = solveCameraProblem(problem, start, solver);
  if (!solution.converged) return std::nullopt;
  CameraStageResult report = resultFrom(*session_, problem, solution.estimate);
  // A failure, that is: the frames leave a parameter free.
  if (addCovariance(reducedInformation(solution.normals), report)) return std::nullopt;
  return ViewSolution{std::move(solution.estimate), report.summary.entropy_nats};
}

void ViewPool::addErrors(const CameraEstimate& cameras, int frame, const Transform& T_C0F,
                         std::vector<ImageError>& out) const {
  const Frame& views = frames_[frame];
  for (std::size_t c = 0; c < views.view.size(); ++c) {
    if (views.view[c] < 0) continue;
    const PackedView view = corners_[c].view(views.view[c]);
    const Intrinsics& camera = cameras.intrinsics[c];
    // Corners that the calibration of all frames rejected have weight 0, for every strategy alike.
    const auto errors = viewErrors(camera, cameras.T_C0Ci[c].inverse() * T_C0F, view);
    for (int k = 0; k < view.count; ++k) {
      if (view.w[k] == 0) continue;
      out.push_back(
          {errors[k].squaredNorm(), isNearBorder(view.u[k], view.v[k], camera.resolution)});
    }
  }
}

/// A frame of the recording where its corners want it.
RigView ViewPool::posedView(const CameraEstimate& cameras, int f) const {
  const auto at = static_cast<std::size_t>(f);
  std::vector<FrameView> views;
  RigView rig;
  for (std::size_t c = 0; c < frames_[at].view.size(); ++c) {
    const int view = frames_[at].view[c];
    rig.views.push_back(view >= 0 ? corners_[c].view(view) : PackedView{});
    if (view < 0) continue;
    views.push_back({&cameras.intrinsics[c], rig.views.back(), cameras.T_C0Ci[c].inverse()});
  }
  // Under the batches' loss, from the pose of the calibration of all frames, whatever the cameras.
  const GramOptions gram{.cauchy_px = options_.cauchy_px};
  rig.T_C0F = refinePose(views, T_C0F_[at], {gram, kPoseIterations, kPoseTolerance}).T_C0F;
  return rig;
}

HeldOutError ViewPool::heldOutError(const CameraEstimate& cameras) const {
  std::vector<ImageError> errors;
  for (const int f : split_.held_out) {
    addErrors(cameras, f, posedView(cameras, f).T_C0F, errors);
  }
  return summaryOf(errors, options_.cauchy_px);
}

ViewPool::PosedFrames ViewPool::posed(const CameraEstimate& cameras,
                                      const std::vector<int>& frames) const {
  PosedFrames out;
  for (const int f : frames) {
    RigView rig = posedView(cameras, f);
    std::vector<ImageError> errors;
    addErrors(cameras, f, rig.T_C0F, errors);
    double squares = 0;
    for (const ImageError& e : errors) squares += e.squared_px;
    out.rmse_px.push_back(std::sqrt(squares / std::max(1.0, static_cast<double>(errors.size()))));
    out.views.push_back(std::move(rig));
  }
  return out;
}

std::vector<Eigen::MatrixXd> ViewPool::poolInformation() const {
  return frameInformation(problemOf(split_.pool), reference_.estimate);
}

std::vector<ViewPool::ImageError> ViewPool::referenceErrors(
    const std::vector<int>& pool_frames) const {
  std::vector<ImageError> errors;
  for (const int f : pool_frames) {
    const auto at = std::lower_bound(split_.pool.begin(), split_.pool.end(), f);
    const auto i = static_cast<std::size_t>(at - split_.pool.begin());
    addErrors(reference_.estimate, f, reference_.estimate.T_C0F[i], errors);
  }
  return errors;
}

}  // namespace plumbline
