// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/offset_hint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace plumbline {
namespace {

constexpr int kRuns = 5;
constexpr double kSpacing_s = 3e-3;
constexpr double kFarthest_s = 20e-3;
constexpr int kRounds = 4;
constexpr double kBlock_s = 1;
constexpr std::size_t kFewestBlocks = 8;

/// Of a block of time, at each of the offsets.
struct Block {
  std::array<double, kRuns> squares{}, count{};
};

Block operator-(Block a, const Block& b) {
  for (std::size_t k = 0; k < kRuns; ++k) {
    a.squares[k] -= b.squares[k];
    a.count[k] -= b.count[k];
  }
  return a;
}

/// Frames that every run predicted, by second.
std::vector<Block> blocksOf(const std::array<std::vector<FrameInnovation>, kRuns>& runs) {
  std::map<TimeNs, std::map<std::size_t, FrameInnovation>> frames;
  for (std::size_t k = 0; k < kRuns; ++k) {
    for (const FrameInnovation& f : runs[k]) frames[f.t].emplace(k, f);
  }
  std::map<std::int64_t, Block> blocks;
  const TimeNs start = frames.empty() ? 0 : frames.begin()->first;
  for (const auto& [t, of_run] : frames) {
    if (of_run.size() < kRuns) continue;
    Block& block = blocks[static_cast<std::int64_t>(secondsBetween(start, t) / kBlock_s)];
    for (const auto& [k, f] : of_run) {
      block.squares[k] += f.squares;
      block.count[k] += f.count;
    }
  }
  std::vector<Block> list;
  for (const auto& entry : blocks) list.push_back(entry.second);
  return list;
}

/// Minimum of the least-squares parabola through the means at -2 .. 2 spacings; empty where it has
/// none. With x the spacings, sum x^2 = 10, sum x^4 = 34: slope = sum x J / 10, curvature as below.
std::optional<double> minimumOf(const Block& sum) {
  double slope = 0, bend = 0;
  for (std::size_t k = 0; k < kRuns; ++k) {
    if (!(sum.count[k] > 0)) return std::nullopt;
    const double J = sum.squares[k] / sum.count[k], x = static_cast<double>(k) - 2;
    slope += x * J / 10;
    bend += (x * x - 2) * J / 14;
  }
  if (!(bend > 0)) return std::nullopt;
  return -0.5 * slope / bend * kSpacing_s;
}

/// Leaves out one block after the other.
std::optional<double> jackknife(const std::vector<Block>& blocks, const Block& sum) {
  std::vector<double> minima;
  double mean = 0;
  for (const Block& block : blocks) {
    const auto minimum = minimumOf(sum - block);
    if (!minimum) return std::nullopt;
    minima.push_back(*minimum);
    mean += *minimum / static_cast<double>(blocks.size());
  }
  double squares = 0;
  for (const double m : minima) squares += (m - mean) * (m - mean);
  const auto n = static_cast<double>(blocks.size());
  return std::sqrt(squares * (n - 1) / n);
}

}  // namespace

std::optional<OffsetHint> offsetHint(const InnovationsAt& run) {
  double centre = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::array<std::vector<FrameInnovation>, kRuns> runs;
    for (std::size_t k = 0; k < kRuns; ++k) {
      runs[k] = run(centre + (static_cast<double>(k) - 2) * kSpacing_s);
    }
    const std::vector<Block> blocks = blocksOf(runs);
    if (blocks.size() < kFewestBlocks) return std::nullopt;
    Block sum;
    for (const Block& block : blocks) sum = sum - (Block{} - block);
    const auto minimum = minimumOf(sum);
    if (!minimum) return std::nullopt;
    if (std::abs(*minimum) <= kSpacing_s) {
      const auto std = jackknife(blocks, sum);
      if (!std) return std::nullopt;
      return OffsetHint{centre + *minimum, *std};
    }
    centre += std::clamp(*minimum, -2 * kSpacing_s, 2 * kSpacing_s);
    if (std::abs(centre) > kFarthest_s) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace plumbline
