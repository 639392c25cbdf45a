// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <utility>

#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {
namespace {

constexpr double kFirstDamping = 1e-6;
constexpr double kLeastDamping = 1e-12;
constexpr double kMostDamping = 1e6;
constexpr double kFreeDamping = 1e-3;      // above it a short step does not mean a minimum
constexpr double kStaleOffset = 2e-4;      // [s] of offset for which the weights still serve
constexpr double kRoundingOfCost = 1e-12;  // relative
constexpr double kSlowRatio = 0.5;         // steps that shrink slower are lengthened,
constexpr double kStallRatio = 0.95;       // unless they hardly shrink at all
constexpr double kSteady = 0.05;           // change of the ratio

class Solver {
 public:
  Solver(const CameraImuProblem& problem, const SolverOptions& options, bool renew_weights)
      : problem_(problem), options_(options), renew_weights_(renew_weights) {}

  CameraImuSolution run(const CameraImuEstimate& start, std::optional<ImuWeights> weights) {
    s_.estimate = start;
    if (!weights) weights = imuWeights(problem_, start);
    if (!weights) return ended(SolverEnd::kLeftSamples);
    s_.weights = std::move(*weights);
    weights_offset_s_ = start.time_offset_s;
    auto normals = normalsAt(problem_, start, s_.weights);
    if (!normals) return ended(SolverEnd::kLeftSamples);
    s_.normals = std::move(*normals);
    while (s_.iterations < options_.max_iterations) {
      const std::optional<SolverEnd> end = iterate();
      if (end) return ended(*end);
    }
    return ended(SolverEnd::kOutOfIterations);
  }

 private:
  CameraImuSolution ended(SolverEnd end) {
    s_.end = end;
    return std::move(s_);
  }

  bool isStale(double offset_s) const {
    if (!renew_weights_) return false;
    return accepted_ == 1 || std::abs(offset_s - weights_offset_s_) > kStaleOffset;
  }

  bool isBetter(const std::optional<CameraImuNormals>& normals) const {
    return normals && normals->cost <= s_.normals.cost * (1 + kRoundingOfCost);
  }

  /// Where steps shrink by a steady ratio q (the noise of single samples in the derivative by t_d
  /// makes Gauss-Newton fall short at high rates of a noisy IMU), goes the whole way that all the
  /// steps to come would add up to: 1 / (1 - q) of a step.
  void lengthen(ChainSolution& step) {
    const double length = std::sqrt(std::max(0.0, step.decrement));
    const double ratio = length / last_length_;
    const bool steady = damping_ < kFreeDamping && ratio > kSlowRatio && ratio < kStallRatio &&
                        std::abs(ratio - last_ratio_) < kSteady;
    last_length_ = length;
    last_ratio_ = ratio;
    if (!steady) return;
    const double factor = 1 / (1 - ratio);
    for (auto& x : step.step) x *= factor;
    step.border_step *= factor;
    last_ratio_ = 0;  // the next one says nothing of the ratio
    last_length_ = 0;
  }

  std::optional<SolverEnd> rejected() {
    last_ratio_ = last_length_ = 0;
    return raiseDamping();
  }

  /// One step; says how it ended if it was the last.
  std::optional<SolverEnd> iterate() {
    auto step = solveChain(s_.normals.chain, {damping_, problem_.threads});
    if (!step) return raiseDamping();
    ++s_.iterations;
    lengthen(*step);
    CameraImuEstimate candidate = moved(s_.estimate, *step, problem_.free_cameras);
    const bool stale = isStale(candidate.time_offset_s);
    std::optional<ImuWeights> fresh;
    if (stale) {
      fresh = imuWeights(problem_, candidate);
      if (!fresh) return SolverEnd::kLeftSamples;
    }
    auto normals = normalsAt(problem_, candidate, fresh ? *fresh : s_.weights);
    if (!normals) return SolverEnd::kLeftSamples;
    // Costs compare under the same weights only.
    const bool better =
        isBetter(normals) || (stale && isBetter(normalsAt(problem_, candidate, s_.weights)));
    const bool small =
        damping_ < kFreeDamping && std::sqrt(std::max(0.0, step->decrement)) < options_.tolerance;
    if (!better && small && !stale) return SolverEnd::kConverged;  // rounding decides from here
    if (!better) return rejected();
    accept(std::move(candidate), std::move(*normals), std::move(fresh));
    if (small && !stale) return SolverEnd::kConverged;
    return std::nullopt;
  }

  void accept(CameraImuEstimate candidate, CameraImuNormals normals,
              std::optional<ImuWeights> fresh) {
    s_.estimate = std::move(candidate);
    s_.normals = std::move(normals);
    if (fresh) {
      s_.weights = std::move(*fresh);
      weights_offset_s_ = s_.estimate.time_offset_s;
    }
    damping_ = std::max(0.1 * damping_, kLeastDamping);
    ++accepted_;
  }

  std::optional<SolverEnd> raiseDamping() {
    damping_ = std::max(damping_ * 100, kFirstDamping);
    if (damping_ > kMostDamping) return SolverEnd::kSingular;
    return std::nullopt;
  }

  const CameraImuProblem& problem_;
  const SolverOptions& options_;
  const bool renew_weights_;
  CameraImuSolution s_;
  double damping_ = kFirstDamping;
  double last_length_ = 0;  // of the last step, in standard deviations; 0: says nothing
  double last_ratio_ = 0;
  double weights_offset_s_ = 0;
  int accepted_ = 0;
};

}  // namespace

CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const SolverOptions& options) {
  return Solver(problem, options, true).run(start, std::nullopt);
}

CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const ImuWeights& weights, const SolverOptions& options) {
  return Solver(problem, options, false).run(start, weights);
}

}  // namespace plumbline
