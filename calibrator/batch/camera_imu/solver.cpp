// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {
namespace {

constexpr double kStaleOffset = 2e-4;  // [s] of offset for which the weights still serve
constexpr double kSlowRatio = 0.5;     // steps that shrink slower are lengthened,
constexpr double kStallRatio = 0.95;   // unless they hardly shrink at all
constexpr double kSteady = 0.05;       // change of the ratio
constexpr double kFreeDamping = 1e-3;  // above it the damping sets the steps' lengths

/// The camera-IMU batch as minimise() wants it.
///
/// The covariance of the pre-integrated motion follows from the samples between two frames, so it
/// changes with the time offset and a little with the biases. Weights that moved with every step
/// would add their own derivative to the cost, so they stand still until they are stale: after the
/// second step, when the biases have their size, and whenever the offset has moved by more than
/// kStaleOffset since. A step with new weights is judged by the old ones where the new raise the
/// cost, and is never the last.
class CameraImuSteps {
 public:
  enum class Weights { kRenewed, kFixed };

  CameraImuSteps(const CameraImuProblem& problem, const CameraImuEstimate& start,
                 ImuWeights weights, Weights renewal)
      : problem_(problem), renewal_(renewal), weights_offset_s_(start.timeOffset()) {
    s_.estimate = start;
    s_.weights = std::move(weights);
  }

  /// False where the start has left the samples.
  bool evaluateStart() {
    auto normals = normalsAt(problem_, s_.estimate, s_.weights);
    if (normals) s_.normals = std::move(*normals);
    return normals.has_value();
  }

  double cost() const { return s_.normals.cost; }

  std::optional<double> solve(double damping) {
    step_ = solveChain(s_.normals.chain, {damping, problem_.threads});
    if (!step_) return std::nullopt;
    // Of the step as solved: what the quadratic model promises, before it is lengthened.
    const double decrement = step_->decrement;
    lengthen(damping);
    return decrement;
  }

  Trial attempt() {
    next_ = moved(s_.estimate, *step_, problem_.free_cameras);
    fresh_.reset();
    const bool stale = isStale(next_.timeOffset());
    if (stale && !(fresh_ = imuWeights(problem_, next_))) return {.left_domain = true};
    auto normals = normalsAt(problem_, next_, fresh_ ? *fresh_ : s_.weights);
    if (!normals) return {.left_domain = true};
    next_normals_ = std::move(*normals);
    double cost = next_normals_.cost;
    if (stale && !(cost <= s_.normals.cost)) {  // costs compare under the same weights only
      if (const auto old = normalsAt(problem_, next_, s_.weights)) cost = old->cost;
    }
    return {.cost = cost, .renewed = stale};
  }

  void accept() {
    s_.estimate = std::move(next_);
    s_.normals = std::move(next_normals_);
    if (fresh_) {
      s_.weights = std::move(*fresh_);
      weights_offset_s_ = s_.estimate.timeOffset();
    }
    ++accepted_;
  }

  /// A lengthened step that is refused says nothing of the damping: the step itself comes next.
  bool refuse() {
    last_ratio_ = last_length_ = 0;
    return std::exchange(lengthened_, false);
  }

  CameraImuSolution solution(const MinimiserSummary& summary) && {
    s_.end = summary.end;
    s_.iterations = summary.iterations;
    return std::move(s_);
  }

 private:
  bool isStale(double offset_s) const {
    if (renewal_ == Weights::kFixed) return false;
    return accepted_ == 1 || std::abs(offset_s - weights_offset_s_) > kStaleOffset;
  }

  /// Where steps shrink by a steady ratio q (the noise of single samples in the derivative by t_d
  /// makes Gauss-Newton fall short at high rates of a noisy IMU), goes the whole way that all the
  /// steps to come would add up to: 1 / (1 - q) of a step.
  void lengthen(double damping) {
    const double length = std::sqrt(std::max(0.0, step_->decrement));
    const double ratio = length / last_length_;
    const bool steady = damping < kFreeDamping && ratio > kSlowRatio && ratio < kStallRatio &&
                        std::abs(ratio - last_ratio_) < kSteady;
    last_length_ = length;
    last_ratio_ = ratio;
    lengthened_ = steady;
    if (!steady) return;
    const double factor = 1 / (1 - ratio);
    for (auto& x : step_->step) x *= factor;
    step_->border_step *= factor;
    last_ratio_ = last_length_ = 0;  // the next step says nothing of the ratio
  }

  const CameraImuProblem& problem_;
  const Weights renewal_;
  CameraImuSolution s_;
  std::optional<ChainSolution> step_;
  CameraImuEstimate next_;
  CameraImuNormals next_normals_;
  std::optional<ImuWeights> fresh_;
  double last_length_ = 0;  // of the last step, in standard deviations; 0: says nothing
  double last_ratio_ = 0;
  bool lengthened_ = false;  // the present step
  double weights_offset_s_ = 0;
  int accepted_ = 0;
};

CameraImuSolution solved(CameraImuSteps steps, const MinimiserOptions& options) {
  MinimiserSummary summary;
  summary.end = MinimiserEnd::kLeftDomain;
  if (steps.evaluateStart()) summary = minimise(steps, options);
  return std::move(steps).solution(summary);
}

}  // namespace

CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const MinimiserOptions& options) {
  auto weights = imuWeights(problem, start);
  if (!weights) return {start, {}, CameraImuNormals(), MinimiserEnd::kLeftDomain, 0};
  return solved({problem, start, std::move(*weights), CameraImuSteps::Weights::kRenewed}, options);
}

CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const ImuWeights& weights, const MinimiserOptions& options) {
  return solved({problem, start, weights, CameraImuSteps::Weights::kFixed}, options);
}

}  // namespace plumbline
