// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/model_choice.h"
#include "calibrator/batch/camera/stage.h"

namespace plumbline {
namespace {

constexpr int kBlocks = 10;             // of time, for the held-out error
constexpr int kLeastFrames = 2;         // in a block
constexpr double kTestTolerance = 0.1;  // of the halves' solutions [standard deviations]

/// A problem on some of the frames of another, with their poses.
CameraPart partOf(const CameraProblem& problem, const CameraEstimate& estimate,
                  const std::vector<int>& frames) {
  CameraPart part{problem, estimate};
  keepFrames(frames, part.problem, part.estimate);
  return part;
}

/// Blocks of every n-th frame; a frame's block is its index. Of time, not frame by frame:
/// neighbours show nearly the same, and a frame between two that were seen is hardly unseen. The
/// stride is rounded down, so that up to twice `most_frames` take part, and a recording with less
/// than that loses none.
std::vector<std::vector<int>> blocksOf(int frames, int most_frames) {
  const int stride = std::max(1, frames / most_frames);
  const int count = (frames + stride - 1) / stride;
  const int blocks = std::min(kBlocks, count / kLeastFrames);
  std::vector<std::vector<int>> out(std::max(0, blocks));
  for (int i = 0; i < count && blocks > 0; ++i) {
    out[i * blocks / count].push_back(i * stride);
  }
  return out;
}

/// Cost of each frame with the cameras of `trained`, the poses refined.
std::vector<double> heldOutCosts(CameraPart part, const CameraEstimate& trained,
                                 std::span<const PackedCorners> corners) {
  part.estimate.intrinsics = trained.intrinsics;
  part.estimate.T_C0Ci = trained.T_C0Ci;
  part.problem.corners = corners;
  return refinePoses(part.problem, part.estimate).cost;
}

}  // namespace

double HeldOut::rms() const { return std::sqrt(squared / std::max(1., corners)); }

MinimiserOptions roughSolver() { return {.tolerance = kTestTolerance}; }

CameraPart testedPart(const CameraProblem& problem, const CameraEstimate& estimate,
                      int most_frames) {
  std::vector<int> frames;
  for (const auto& block : blocksOf(problem.frameCount(), most_frames)) {
    frames.insert(frames.end(), block.begin(), block.end());
  }
  return partOf(problem, estimate, frames);
}

HeldOut heldOut(const CameraProblem& problem, const CameraEstimate& from, BoardDetail detail,
                int most_frames, const MinimiserOptions& solver) {
  const auto blocks = blocksOf(problem.frameCount(), most_frames);
  HeldOut out;
  // Neither half would train the other.
  if (blocks.size() < 2) return out;
  out.cost.resize(blocks.size());
  std::vector<PackedCorners> placed;
  // Every other block, so that both halves span the recording.
  for (std::size_t parity = 0; parity < 2; ++parity) {
    std::vector<int> seen;
    for (std::size_t b = parity; b < blocks.size(); b += 2) {
      seen.insert(seen.end(), blocks[b].begin(), blocks[b].end());
    }
    CameraPart training = partOf(problem, from, seen);
    CameraSolution trained = solveCameraProblem(training.problem, training.estimate, solver);
    if (detail != BoardDetail::kTwelve) {
      trained = withHigherTerms(training.problem, std::move(trained), solver, {detail, 1});
    }
    out.converged = out.converged && trained.converged;
    // The board that the training half has found goes with its cameras: with terms of their own the
    // test frames would not be unseen.
    std::span<const PackedCorners> corners = problem.corners;
    if (trained.estimate.target) {
      placed.assign(corners.begin(), corners.end());
      placeCorners(training.problem.target->grid, trained.estimate, placed);
      corners = placed;
    }
    for (std::size_t b = 1 - parity; b < blocks.size(); b += 2) {
      // Poses start from `from`, the same whichever half was trained.
      const CameraPart test = partOf(problem, from, blocks[b]);
      const std::vector<double> costs = heldOutCosts(test, trained.estimate, corners);
      double sum = 0, count = 0;
      for (std::size_t f = 0; f < costs.size(); ++f) {
        sum += costs[f];
        // With their weights: what a filter rejected adds neither to the cost nor to the count.
        count += usedCount(test.problem.frames[f], test.problem.corners);
      }
      out.cost[b] = sum / std::max(1., count);
      out.squared += sum;
      out.frames += test.problem.frameCount();
      out.corners += count;
    }
  }
  return out;
}

MeanGain meanGain(const std::vector<double>& from, const std::vector<double>& to) {
  const auto n = static_cast<double>(from.size());
  MeanGain gain;
  if (n < 2) return gain;  // no scatter
  for (std::size_t b = 0; b < from.size(); ++b) gain.mean += (from[b] - to[b]) / n;
  // Paired by block: what makes a block hard is in both costs and drops out of their difference.
  double square = 0;
  for (std::size_t b = 0; b < from.size(); ++b) {
    const double d = from[b] - to[b] - gain.mean;
    square += d * d;
  }
  gain.std = std::sqrt(square / (n - 1) / n);
  return gain;
}

}  // namespace plumbline
