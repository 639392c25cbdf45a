// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/target.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "calibrator/batch/camera/robust_covariance.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

constexpr int kBlocks = 10;         // of time, for the held-out error
constexpr int kLeastFrames = 2;     // in a block
constexpr int kFramesOfTest = 400;  // every n-th frame says as much (0.04 px in EuRoC's cameras)
constexpr double kGainSigmas = 2;   // of the mean gain
constexpr double kTestTolerance = 0.1;  // of the halves' solutions [standard deviations]

double usedCorners(const CameraProblem& problem, std::size_t f) {
  double corners = 0;
  for (std::size_t c = 0; c < problem.frames[f].view.size(); ++c) {
    const int index = problem.frames[f].view[c];
    if (index < 0) continue;
    const PackedView view = problem.corners[c].view(index);
    for (int k = 0; k < view.count; ++k) corners += view.w[k];
  }
  return corners;
}

/// A problem on some of the frames of another, with their poses.
struct Part {
  CameraProblem problem;
  CameraEstimate estimate;
};

Part partOf(const CameraProblem& problem, const CameraEstimate& estimate,
            const std::vector<int>& frames) {
  Part part{problem, estimate};
  part.problem.frames.clear();
  part.problem.weights.clear();
  part.estimate.T_C0F.clear();
  for (const int f : frames) {
    part.problem.frames.push_back(problem.frames[static_cast<std::size_t>(f)]);
    part.estimate.T_C0F.push_back(estimate.T_C0F[static_cast<std::size_t>(f)]);
  }
  return part;
}

/// Blocks of every n-th frame; a frame's block is its index.
std::vector<std::vector<int>> blocksOf(int frames) {
  const int stride = std::max(1, frames / kFramesOfTest);
  const int count = (frames + stride - 1) / stride;
  const int blocks = std::min(kBlocks, count / kLeastFrames);
  std::vector<std::vector<int>> out(static_cast<std::size_t>(std::max(0, blocks)));
  for (int i = 0; i < count && blocks > 0; ++i) {
    out[static_cast<std::size_t>(i * blocks / count)].push_back(i * stride);
  }
  return out;
}

/// Cost of each frame with the cameras of `trained`, the poses refined.
std::vector<double> heldOutCosts(Part part, const CameraEstimate& trained,
                                 std::span<const PackedCorners> corners) {
  part.estimate.intrinsics = trained.intrinsics;
  part.estimate.T_C0Ci = trained.T_C0Ci;
  part.problem.corners = corners;
  return refinePoses(part.problem, part.estimate).cost;
}

/// Sums over the blocks that a solution did not see.
struct HeldOut {
  std::vector<double> cost;  ///< per block, per corner [px^2]
  double squared = 0;        ///< of all [px^2]
  double corners = 0;

  double rms() const { return std::sqrt(squared / std::max(1., corners)); }
};

HeldOut heldOut(const AprilGrid& board, const CameraProblem& problem, const CameraEstimate& from) {
  const auto blocks = blocksOf(problem.frameCount());
  HeldOut out;
  out.cost.resize(blocks.size());
  MinimiserOptions rough;
  rough.tolerance = kTestTolerance;
  for (std::size_t parity = 0; parity < 2; ++parity) {
    std::vector<int> seen;
    for (std::size_t b = parity; b < blocks.size(); b += 2) {
      seen.insert(seen.end(), blocks[b].begin(), blocks[b].end());
    }
    const Part training = partOf(problem, from, seen);
    const CameraSolution trained = solveCameraProblem(training.problem, training.estimate, rough);
    std::span<const PackedCorners> corners = problem.corners;
    std::vector<PackedCorners> placed;
    if (trained.estimate.target) {
      placed.assign(corners.begin(), corners.end());
      placeCorners(board, trained.estimate, placed);
      corners = placed;
    }
    for (std::size_t b = 1 - parity; b < blocks.size(); b += 2) {
      const Part test = partOf(problem, from, blocks[b]);
      const std::vector<double> costs = heldOutCosts(test, trained.estimate, corners);
      double sum = 0, count = 0;
      for (std::size_t f = 0; f < costs.size(); ++f) {
        sum += costs[f];
        count += usedCorners(test.problem, f);
      }
      out.cost[b] = sum / std::max(1., count);
      out.squared += sum;
      out.corners += count;
    }
  }
  return out;
}

/// Mean of a block's gain, and the standard deviation of that mean.
std::pair<double, double> meanGain(const std::vector<double>& from, const std::vector<double>& to) {
  const auto n = static_cast<double>(from.size());
  double mean = 0, square = 0;
  for (std::size_t b = 0; b < from.size(); ++b) mean += (from[b] - to[b]) / n;
  for (std::size_t b = 0; b < from.size(); ++b) {
    const double d = from[b] - to[b] - mean;
    square += d * d;
  }
  return {mean, std::sqrt(square / (n - 1) / n)};
}

/// The cameras with the other of the two lens models that are calibrated, without distortion yet.
CameraEstimate withOtherLenses(CameraEstimate estimate) {
  for (Intrinsics& lens : estimate.intrinsics) {
    const bool radtan = lens.distortion_model == DistortionModel::kRadtan;
    lens.distortion_model = radtan ? DistortionModel::kEquidistant : DistortionModel::kRadtan;
    lens.distortion.setZero();
  }
  return estimate;
}

/// Whether the board's terms hide what the lens model leaves: the other lens model, with terms of
/// its own, predicts unseen frames better. Board and lens cannot be told apart then. In EuRoC's
/// imu_april radtan with terms leaves 0.38 px and moves the focal length by 5 px; equidistant with
/// terms leaves 0.32 px.
bool otherLensIsBetter(const AprilGrid& board, const CameraProblem& problem,
                       const CameraEstimate& bent, const HeldOut& with) {
  MinimiserOptions rough;
  rough.tolerance = kTestTolerance;
  std::vector<int> frames;
  for (const auto& block : blocksOf(problem.frameCount())) {
    frames.insert(frames.end(), block.begin(), block.end());
  }
  Part part = partOf(problem, withOtherLenses(bent), frames);
  const CameraSolution other = solveCameraProblem(part.problem, part.estimate, rough);
  if (!other.converged) return false;
  CameraEstimate all = bent;
  all.intrinsics = other.estimate.intrinsics;
  all.T_C0Ci = other.estimate.T_C0Ci;
  all.target = other.estimate.target;
  const HeldOut without = heldOut(board, problem, all);
  const auto [gain, std] = meanGain(with.cost, without.cost);
  return gain > kGainSigmas * std;
}

TargetFinding findingOf(const TargetFit& fit, const CameraStageOptions& options) {
  if (!(fit.std.maxCoeff() <= options.target_max_std)) return TargetFinding::kUndetermined;
  return fit.gain_px2 > kGainSigmas * fit.gain_std_px2 ? TargetFinding::kBent
                                                       : TargetFinding::kAsStated;
}

TargetFit judge(const AprilGrid& board, const CameraProblem& problem, const CameraSolution& bent,
                const CameraSolution& flat, const CameraStageOptions& options) {
  TargetFit fit;
  fit.shape.terms = *bent.estimate.target;
  const auto formal = covarianceOf(reducedInformation(bent.normals));
  if (!bent.converged || !formal) return fit;
  fit.shape.covariance = formal->bottomRightCorner<kTargetTerms, kTargetTerms>();
  fit.std = fit.shape.covariance->diagonal().cwiseSqrt();
  if (const auto robust = robustCovariance(problem, bent)) {
    fit.blocks = robust->blocks;
    fit.std = fit.std.cwiseMax(robust->matrix.diagonal().tail<kTargetTerms>().cwiseSqrt());
  }
  const HeldOut with = heldOut(board, problem, bent.estimate);
  if (with.cost.size() < 4) return fit;  // two blocks a side: fewer have no scatter
  const HeldOut without = heldOut(board, problem, flat.estimate);
  fit.held_out_px = with.rms();
  fit.flat_held_out_px = without.rms();
  std::tie(fit.gain_px2, fit.gain_std_px2) = meanGain(without.cost, with.cost);
  fit.finding = findingOf(fit, options);
  if (fit.finding == TargetFinding::kBent &&
      otherLensIsBetter(board, problem, bent.estimate, with)) {
    fit.finding = TargetFinding::kLensMisfits;
  }
  return fit;
}

}  // namespace

TargetSolution estimateTarget(const AprilGrid& board, CameraProblem& problem, CameraSolution flat,
                              const CameraStageOptions& options) {
  if (options.target == TargetMode::kGiven || !flat.converged) return {std::move(flat), {}};
  problem.target = std::make_shared<TargetModel>(board);
  CameraEstimate start = flat.estimate;
  start.target = board.shape.terms;
  CameraSolution bent = solveCameraProblem(problem, start, solverOptions(options));
  bent.iterations += flat.iterations;
  TargetFit fit = judge(board, problem, bent, flat, options);
  const bool keep =
      options.target == TargetMode::kEstimate
          ? bent.converged
          : options.target == TargetMode::kAuto && fit.finding == TargetFinding::kBent;
  return {keep ? std::move(bent) : std::move(flat), std::move(fit)};
}

}  // namespace plumbline
