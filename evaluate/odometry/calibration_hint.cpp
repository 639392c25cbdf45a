// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/calibration_hint.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "calibrator/base/transform.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kRounds = 5;
constexpr double kFarthestSteps = 2;  // that one round moves
constexpr double kMostOffset_s = 20e-3, kMostShift_m = 0.15, kMostTurn_rad = 2.5 * kDegree;
// A step shall raise the mean by this share: far above what a hair's breadth does to an odometry's
// choice of tracks, and below where gates and the cap of a sighting's error bend the quadratic.
constexpr double kRise = 0.02;
constexpr double kMostFactor = 3;       // by which one round may change a step
constexpr double kFittingFactor = 2.5;  // up to which a step is as long as it should be
constexpr double kBlock_s = 1;

/// t_d [s], and of extrinsics the axes of translation [m] and rotation [rad].
VectorXd valuesOf(HintKind kind, double offset_s, double shift_m, double turn_rad) {
  if (kind == HintKind::kOffset) return VectorXd::Constant(1, offset_s);
  VectorXd values(7);
  values << offset_s, shift_m, shift_m, shift_m, turn_rad, turn_rad, turn_rad;
  return values;
}

/// Where the runs are made, in steps: the centre, every axis both ways, every pair of axes.
std::vector<VectorXd> designOf(Index n) {
  std::vector<VectorXd> places{VectorXd::Zero(n)};
  for (Index i = 0; i < n; ++i) {
    places.emplace_back(VectorXd::Unit(n, i));
    places.emplace_back(-VectorXd::Unit(n, i));
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < i; ++j) places.emplace_back(VectorXd::Unit(n, i) + VectorXd::Unit(n, j));
  }
  return places;
}

/// Of a block of time, at each place.
struct Block {
  Eigen::ArrayXd squares, count;
};

/// In the order of designOf(), which quadraticOf() counts on.
std::vector<std::vector<FrameInnovation>> runsAround(const VectorXd& centre, const VectorXd& steps,
                                                     const InnovationsAt& run, int threads) {
  const std::vector<VectorXd> design = designOf(steps.size());
  std::vector<std::vector<FrameInnovation>> runs(design.size());
  parallelFor(design.size(), threads,
              [&](int, std::size_t k) { runs[k] = run(centre + steps.cwiseProduct(design[k])); });
  return runs;
}

/// Frames that every run predicted, by second.
std::vector<Block> blocksOf(const std::vector<std::vector<FrameInnovation>>& runs) {
  std::map<TimeNs, std::map<std::size_t, FrameInnovation>> frames;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    for (const FrameInnovation& f : runs[k]) frames[f.t].emplace(k, f);
  }
  const auto n = static_cast<Index>(runs.size());
  std::map<std::int64_t, Block> blocks;
  const TimeNs start = frames.empty() ? 0 : frames.begin()->first;
  for (const auto& [t, of_run] : frames) {
    // A frame that some runs did not predict would make J differ by which frames it is a mean over.
    if (of_run.size() < runs.size()) continue;
    const auto second = static_cast<std::int64_t>(secondsBetween(start, t) / kBlock_s);
    Block& block =
        blocks.try_emplace(second, Block{Eigen::ArrayXd::Zero(n), Eigen::ArrayXd::Zero(n)})
            .first->second;
    for (const auto& [k, f] : of_run) {
      block.squares[static_cast<Index>(k)] += f.squares;
      block.count[static_cast<Index>(k)] += f.count;
    }
  }
  std::vector<Block> list;
  for (auto& entry : blocks) list.push_back(std::move(entry.second));
  return list;
}

/// The quadratic through the means, in steps.
struct Quadratic {
  double J0 = 0;
  VectorXd g;
  MatrixXd H;

  std::optional<VectorXd> minimum() const {
    const Eigen::LLT<MatrixXd> llt(H);
    if (llt.info() != Eigen::Success) return std::nullopt;
    return VectorXd(-llt.solve(g));
  }

  /// Where there is no minimum (pairs of axes are noisy while a step is too short): axis by axis.
  VectorXd descent() const {
    VectorXd x(g.size());
    for (Index i = 0; i < g.size(); ++i) {
      x[i] = H(i, i) > 0 ? -g[i] / H(i, i) : std::copysign(kFarthestSteps, -g[i]);
    }
    return x;
  }

  /// By how much each step is too short to raise J by kRise, or (below 1) too long.
  VectorXd stepFactors() const {
    // A step raises J by H_ii / 2, and with it by the square of a factor.
    const Eigen::ArrayXd rise = H.diagonal() / 2;
    const Eigen::ArrayXd fitting = (kRise * J0 / rise).sqrt();
    const Eigen::ArrayXd factors = (rise > 0).select(fitting, kMostFactor);
    return factors.cwiseMax(1 / kMostFactor).cwiseMin(kMostFactor);
  }
};

/// Empty where a place has no sightings.
std::optional<Quadratic> quadraticOf(Index n, const Block& sum) {
  if (!(sum.count > 0).all()) return std::nullopt;
  // Over all sightings, so that a frame counts by how many it had.
  const VectorXd J = sum.squares / sum.count;
  const auto along = [&](Index i) { return J[1 + 2 * i]; };
  const auto against = [&](Index i) { return J[2 + 2 * i]; };
  Quadratic q{J[0], VectorXd(n), MatrixXd(n, n)};
  // Pairs stand behind the centre and both ways of every axis.
  Index pair = 1 + 2 * n;
  for (Index i = 0; i < n; ++i) {
    q.g[i] = (along(i) - against(i)) / 2;
    q.H(i, i) = along(i) + against(i) - 2 * J[0];
    for (Index j = 0; j < i; ++j) {
      q.H(i, j) = q.H(j, i) = J[pair++] - along(i) - along(j) + J[0];
    }
  }
  return q;
}

Block sumOf(const std::vector<Block>& blocks) {
  Block sum = blocks.front();
  for (std::size_t k = 1; k < blocks.size(); ++k) {
    sum.squares += blocks[k].squares;
    sum.count += blocks[k].count;
  }
  return sum;
}

/// Standard deviations of the minimum: leaves out one block after the other.
std::optional<VectorXd> jackknife(Index n, const std::vector<Block>& blocks, const Block& sum) {
  MatrixXd minima(n, static_cast<Index>(blocks.size()));
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    // The same runs without the block: nothing is run again.
    const auto q = quadraticOf(n, {sum.squares - blocks[k].squares, sum.count - blocks[k].count});
    const auto minimum = q ? q->minimum() : std::nullopt;
    if (!minimum) return std::nullopt;
    minima.col(static_cast<Index>(k)) = *minimum;
  }
  // (n - 1) / n sum (x_k - mean)^2 over the estimates x_k without block k.
  const MatrixXd off = minima.colwise() - minima.rowwise().mean();
  const auto count = static_cast<double>(blocks.size());
  return VectorXd((off.rowwise().squaredNorm() * ((count - 1) / count)).cwiseSqrt());
}

HintResult noHint(std::string why) { return {std::nullopt, std::move(why)}; }

std::string fewSecondsText(std::size_t blocks) {
  return fmt::format(
      "the runs with changed calibrations predicted frames in only {} common seconds of the {} "
      "that "
      "are needed",
      blocks, kFewestHintBlocks);
}

std::string farText(HintKind kind) {
  const std::string pose =
      kind == HintKind::kExtrinsics
          ? fmt::format(", {:g} mm or {:g} deg", 1e3 * kMostShift_m, kMostTurn_rad / kDegree)
          : "";
  return fmt::format(
      "the search for a minimum of the innovations led more than {:g} ms{} from the calibration",
      1e3 * kMostOffset_s, pose);
}

}  // namespace

Calibration changed(Calibration calibration, const VectorXd& change) {
  assert(calibration.imu && (change.size() == 1 || change.size() == 7));
  for (TimeOffset& offset : calibration.imu->time_offsets) offset.s += change[0];
  if (change.size() == 7) {
    calibration.imu->T_SC0 = boxplus(calibration.imu->T_SC0, Vector6d(change.tail<6>()));
  }
  return calibration;
}

int hintBlocks(const std::vector<FrameInnovation>& innovations) {
  return static_cast<int>(blocksOf({innovations}).size());
}

std::string tooFewBlocks(const std::vector<FrameInnovation>& innovations, double duration_s) {
  const int blocks = hintBlocks(innovations);
  if (blocks >= kFewestHintBlocks) return "";
  return fmt::format("{}the odometry predicted frames in only {} of the {} seconds that are needed",
                     duration_s < kFewestHintBlocks * kBlock_s ? "the flight is too short: " : "",
                     blocks, kFewestHintBlocks);
}

HintResult calibrationHint(HintKind kind, const InnovationsAt& run, int threads) {
  assert(kind != HintKind::kNone);
  const VectorXd most = valuesOf(kind, kMostOffset_s, kMostShift_m, kMostTurn_rad);
  VectorXd steps = valuesOf(kind, 3e-3, 0.02, 0.3 * kDegree);
  const Index n = steps.size();
  VectorXd centre = VectorXd::Zero(n);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Block> blocks = blocksOf(runsAround(centre, steps, run, threads));
    if (blocks.size() < kFewestHintBlocks) return noHint(fewSecondsText(blocks.size()));
    const Block sum = sumOf(blocks);
    const auto q = quadraticOf(n, sum);
    if (!q) return noHint("a run with a changed calibration saw no landmark that it knew");
    const auto minimum = q->minimum();
    const VectorXd factors = q->stepFactors();
    const bool fits =
        (factors.array() > 1 / kFittingFactor && factors.array() < kFittingFactor).all();
    // Only inside the steps is the quadratic that of the innovations, and not extrapolated.
    if (minimum && fits && (minimum->array().abs() <= 1).all()) {
      const auto std = jackknife(n, blocks, sum);
      if (!std) return noHint("the innovations have a minimum by a single second alone");
      return {CalibrationHint{centre + steps.cwiseProduct(*minimum), steps.cwiseProduct(*std)}, ""};
    }
    // A quadratic far from its minimum may point anywhere, so no round moves far.
    const VectorXd move = minimum.value_or(q->descent());
    centre += steps.cwiseProduct(VectorXd(move.cwiseMax(-kFarthestSteps).cwiseMin(kFarthestSteps)));
    // Beyond what a calibration may be wrong by something else draws it there.
    if ((centre.array().abs() > most.array()).any()) return noHint(farText(kind));
    steps = steps.cwiseProduct(factors);
  }
  return noHint(fmt::format(
      "the search for a minimum of the innovations did not settle in {} rounds", kRounds));
}

}  // namespace plumbline
