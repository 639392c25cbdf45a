// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <random>

namespace plumbline {

/// What a stream of random numbers is for. Every purpose has streams of its own, so that switching
/// one effect on or off never moves the numbers of another.
enum class RandomPurpose : std::uint64_t {
  kTrajectory = 1,
  kCornerNoise,
  kOutliers,
  kDroppedFrames,
  kStampJitter,
  kGyroNoise,
  kGyroWalk,
  kAccelNoise,
  kAccelWalk,
  kImageNoise,
  kDroppedSamples,
  kFault,
  kFlight,
  kLandmarks,
  kTracks,
  kTexture,
  kMotionCapture,
};

/// Reproducible random numbers: std::mt19937_64 (its sequence is fixed by the standard) with
/// transforms of our own (those of <random>'s distributions are not). Every draw consumes a fixed
/// number of engine outputs.
class RandomStream {
 public:
  /// The stream of `seed` for `purpose`, one for each `indices` (camera, frame, ...).
  RandomStream(std::uint64_t seed, RandomPurpose purpose,
               std::initializer_list<std::uint64_t> indices = {});

  /// 64 random bits: one output.
  std::uint64_t bits() { return engine_(); }
  /// Uniform in [0, 1): the upper 53 bits of one output.
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal by Box and Muller (cosine branch): two outputs a draw.
  double normal();
  /// Three of them, x first.
  Eigen::Vector3d normalVector();

 private:
  std::mt19937_64 engine_;
};

}  // namespace plumbline
