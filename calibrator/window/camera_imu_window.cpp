// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/camera_imu_window.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

constexpr double kFirstDamping = 1e-9;  // the window starts next to its minimum
constexpr double kSampleMargin = 0.5;   // [s] of samples kept before the first frame

/// Without those that the batch has rejected.
std::vector<Corner> cornersOf(const PackedView& view) {
  std::vector<Corner> corners;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] > 0) corners.push_back({view.id[k], {view.u[k], view.v[k]}});
  }
  return corners;
}

std::vector<std::vector<Corner>> frameCorners(const CameraImuProblem& problem, const Frame& frame) {
  std::vector<std::vector<Corner>> corners(problem.corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (frame.view[c] >= 0) corners[c] = cornersOf(problem.corners[c].view(frame.view[c]));
  }
  return corners;
}

template <class T>
void dropFront(std::vector<T>& values, int count) {
  values.erase(values.begin(), values.begin() + count);
}

}  // namespace

void CameraImuWindowOptions::check() const {
  requireAtLeast(2, "states", states);
  requireAtLeast(1, "max_iterations", max_iterations);
  requirePositive("tolerance", tolerance);
  requirePositive("max_last_step", max_last_step);
}

std::optional<CameraImuWindow> CameraImuWindow::fromBatch(const CameraImuProblem& problem,
                                                          const CameraImuEstimate& estimate,
                                                          const AprilGrid& target,
                                                          const CameraImuWindowOptions& options) {
  options.check();
  assert(problem.frameCount() >= 2);
  assert(problem.view_stamps.empty() && !problem.free_cameras && !problem.fixed_calibration);
  CameraImuWindow window;
  window.options_ = options;
  window.target_ = target;
  // With all of the batch in it first: marginaliseOldest() makes the prior of what leaves.
  window.problem_ = problem;
  window.problem_.threads = 1;  // three frames
  window.estimate_ = estimate;
  for (const Frame& frame : problem.frames) window.corners_.push_back(frameCorners(problem, frame));
  const auto weights = imuWeights(problem, estimate);
  if (!weights) return std::nullopt;
  window.weights_ = *weights;
  // All frames but the last `states` leave at once, one block after the other.
  if (!window.marginaliseOldest() || !window.solve()) return std::nullopt;
  return window;
}

void CameraImuWindow::addSamples(std::span<const ImuSample> samples) {
  problem_.samples.insert(problem_.samples.end(), samples.begin(), samples.end());
}

WindowEnd CameraImuWindow::add(const WindowFrame& frame) {
  assert(frame.t > (waiting_ ? waiting_->t : lastStamp()));
  assert(frame.link != FrameLink::kBroken);
  // It would enter with a velocity that nothing determines.
  if (frame.link == FrameLink::kBiasWalk) {
    waiting_ = frame;
    return WindowEnd::kWaiting;
  }
  // To go back to: a frame that spoils the window must leave no trace, and its prior cannot be
  // taken apart again.
  CameraImuWindow before = *this;
  const WindowEnd end = addLinked(frame);
  if (end != WindowEnd::kSolved) {
    before.waiting_.reset();
    *this = std::move(before);
  }
  return end;
}

WindowEnd CameraImuWindow::addLinked(const WindowFrame& frame) {
  // A frame behind a pause has no interval that tells its velocity; the frame after it does, by the
  // difference of their positions.
  if (waiting_) {
    ImuState state = estimate_.states.back();
    const Transform T_C0S = estimate_.T_SC0.inverse();
    state.T_FS = waiting_->T_FC0 * T_C0S;
    state.v_F = ((frame.T_FC0 * T_C0S).t - state.T_FS.t) / secondsBetween(waiting_->t, frame.t);
    append(*waiting_, state);
    waiting_.reset();
  }
  append(frame, predicted(frame));
  packCorners();
  // By the states as they start, and held while the window is solved: the offset, by which weights
  // go stale, is held too.
  const auto weights = imuWeights(problem_, estimate_);
  if (!weights) return WindowEnd::kNotSolved;
  weights_ = *weights;
  return marginaliseOldest() && solve() ? WindowEnd::kSolved : WindowEnd::kNotSolved;
}

void CameraImuWindow::append(const WindowFrame& frame, const ImuState& state) {
  problem_.frames.push_back({frame.t, std::vector<int>(frame.corners.size(), -1)});
  problem_.links.push_back(frame.link);
  problem_.weights.push_back(1);
  estimate_.states.push_back(state);
  corners_.push_back(frame.corners);
}

/// Pose from the frame's corners; velocity from the IMU, for a frame's corners say nothing of it.
ImuState CameraImuWindow::predicted(const WindowFrame& frame) const {
  ImuState state = estimate_.states.back();
  // v_j = v_i + g T + R_FSi dv, i the last state.
  const ImuWindow window{lastStamp(), frame.t, estimate_.timeOffset()};
  const auto motion = preintegrate(problem_.samples, window, {state.gyro_bias, state.accel_bias});
  if (motion) {
    state.v_F += problem_.gravity_m_s2 * window.duration_s() * estimate_.gravity_direction +
                 state.T_FS.R * motion->v;
  }
  state.T_FS = frame.T_FC0 * estimate_.T_SC0.inverse();
  return state;
}

void CameraImuWindow::packCorners() {
  for (std::size_t c = 0; c < problem_.corners.size(); ++c) {
    std::vector<ImageView> views;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      // Only frames that a camera sees have a place among its packed views: their indices move as
      // frames leave.
      const std::vector<Corner>& corners = corners_[i][c];
      problem_.frames[i].view[c] = corners.empty() ? -1 : static_cast<int>(views.size());
      if (!corners.empty()) views.push_back({problem_.frames[i].t, corners});
    }
    problem_.corners[c] = PackedCorners(target_, views);
  }
}

/// Brings the window back to its size; what leaves becomes part of the prior.
bool CameraImuWindow::marginaliseOldest() {
  const int count = problem_.frameCount() - options_.states;
  if (count <= 0) return true;
  auto prior = marginaliseFront(problem_, estimate_, weights_, prior_, count);
  if (!prior) return false;
  prior_ = std::move(prior);
  dropFront(problem_.frames, count);
  dropFront(problem_.links, count);
  dropFront(problem_.weights, count);
  dropFront(estimate_.states, count);
  dropFront(weights_, count);
  dropFront(corners_, count);
  packCorners();
  // On the IMU's clock, on which the first link begins.
  const TimeNs first =
      problem_.frames.front().t + toNanoseconds(estimate_.timeOffset() - kSampleMargin);
  std::erase_if(problem_.samples, [first](const ImuSample& s) { return s.t < first; });
  return true;
}

std::optional<CameraImuNormals> CameraImuWindow::system(const CameraImuEstimate& estimate) const {
  auto normals = normalsAt(problem_, estimate, weights_);
  if (!normals) return std::nullopt;
  if (prior_) addPrior(*prior_, estimate, *normals);
  // The time offset keeps the value that the batch gave it.
  normals->chain.hold(BorderLayout::kOffset);
  return normals;
}

class CameraImuWindow::Steps {
 public:
  Steps(CameraImuWindow& window, CameraImuNormals normals)
      : window_(window), normals_(std::move(normals)) {}

  double cost() const { return normals_.cost; }
  const CameraImuNormals& normals() const { return normals_; }

  std::optional<double> solve(double damping) {
    step_ = solveChain(normals_.chain, {damping, 1});
    if (!step_) return std::nullopt;
    return step_->decrement;
  }

  Trial attempt() {
    next_ = moved(window_.estimate_, *step_, false);
    next_normals_ = window_.system(next_);
    if (!next_normals_) return {};  // beyond the samples: refused
    return {.cost = next_normals_->cost};
  }

  void accept() {
    window_.estimate_ = std::move(next_);
    normals_ = std::move(*next_normals_);
  }

  static bool refuse() { return false; }

 private:
  CameraImuWindow& window_;
  CameraImuNormals normals_;
  std::optional<ChainSolution> step_;
  CameraImuEstimate next_;
  std::optional<CameraImuNormals> next_normals_;
};

bool CameraImuWindow::solve() {
  auto normals = system(estimate_);
  if (!normals) return false;
  Steps steps(*this, std::move(*normals));
  const MinimiserSummary summary = minimise(steps, {.max_iterations = options_.max_iterations,
                                                    .tolerance = options_.tolerance,
                                                    .first_damping = kFirstDamping});
  cost_ = steps.normals().cost;
  squared_px_ = steps.normals().squared_px;
  // Out of iterations close to the minimum is a solution as well: the last step says how close.
  return summary.end != MinimiserEnd::kNoStep && summary.last_step < options_.max_last_step;
}

double CameraImuWindow::rmsePx() const {
  std::size_t count = 0;
  for (const auto& frame : corners_) {
    for (const auto& camera : frame) count += camera.size();
  }
  return count > 0 ? std::sqrt(squared_px_ / static_cast<double>(count)) : 0;
}

std::optional<WindowKnowledge> CameraImuWindow::knowledge() const {
  // Of the offset as well, which system() holds: its column is in the information as it is.
  auto cost = frontCost(problem_, estimate_, weights_, prior_, problem_.frameCount() - 1);
  if (!cost) return std::nullopt;
  WindowKnowledge out{std::move(cost->H), estimate_, lastStamp(), std::move(cost->noise)};
  out.estimate.states = {estimate_.states.back()};
  return out;
}

}  // namespace plumbline
