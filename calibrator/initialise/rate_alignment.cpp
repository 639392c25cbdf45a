// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/rate_alignment.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calibrator/base/option_check.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

struct Moments {
  Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_camera = Eigen::Vector3d::Zero();
  Eigen::Matrix3d gyro = Eigen::Matrix3d::Zero();   // centred second moments
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  // gyro camera^T
  double camera = 0;                                // trace of the camera's
};

/// About the means: a constant bias of the gyroscope drops out, and the rotation is found first. In
/// two passes, for squares less the square of a mean would cancel where the bias is large.
Moments momentsOf(std::span<const RatePair> pairs) {
  Moments m;
  const double n = static_cast<double>(pairs.size());
  for (const RatePair& p : pairs) {
    m.mean_gyro += p.gyro_S / n;
    m.mean_camera += p.camera_C / n;
  }
  for (const RatePair& p : pairs) {
    const Eigen::Vector3d g = p.gyro_S - m.mean_gyro;
    const Eigen::Vector3d c = p.camera_C - m.mean_camera;
    m.gyro += g * g.transpose() / n;
    m.cross += g * c.transpose() / n;
    m.camera += c.squaredNorm() / n;
  }
  return m;
}

struct Candidate {
  double offset_s = 0;
  double score = -1;
  std::size_t pairs = 0;  ///< camera rates that the gyro covers
};

/// Correlation of the centred rates after the best rotation or reflection: the nuclear norm of
/// their cross moments (orthogonal Procrustes, Schoenemann 1966) over the product of their norms.
/// It does not depend on the units of either, nor on T_SC0, which is unknown here.
Candidate scoreAt(std::span<const CameraRate> camera, const GyroIntegral& gyro, double offset_s,
                  std::size_t min_pairs) {
  const auto pairs = pairRates(camera, gyro, offset_s);
  Candidate out{offset_s, -1, pairs.size()};
  if (pairs.size() < min_pairs) return out;
  const Moments m = momentsOf(pairs);
  const double scale = std::sqrt(m.gyro.trace() * m.camera);
  out.score = 0;
  if (!(scale > 0)) return out;
  out.score = Eigen::JacobiSVD<Eigen::Matrix3d>(m.cross).singularValues().sum() / scale;
  return out;
}

/// Vertex of the parabola through three points at x - h, x, x + h, at most h away.
double parabolaVertex(double x, double h, double below, double at, double above) {
  const double curvature = below - 2 * at + above;
  if (!(curvature < 0)) return x;
  return x + std::clamp(0.5 * h * (below - above) / curvature, -h, h);
}

struct Grid {
  std::vector<Candidate> candidates;
  std::size_t needed = 0;   ///< rates to be covered
  std::size_t covered = 0;  ///< rates covered at best
};

/// One step more than the range on either side, so that its ends can be local maxima. Offsets that
/// cover too few rates have score -1.
Grid coarseGrid(std::span<const CameraRate> camera, const GyroIntegral& gyro,
                const TimeOffsetOptions& options) {
  Grid grid;
  const auto fewest = static_cast<std::size_t>(options.min_pairs);
  const int steps = static_cast<int>(std::ceil(options.max_offset_s / options.coarse_step_s));
  for (int k = -steps - 1; k <= steps + 1; ++k) {
    grid.candidates.push_back(scoreAt(camera, gyro, k * options.coarse_step_s, fewest));
    grid.covered = std::max(grid.covered, grid.candidates.back().pairs);
  }
  // Offsets near the end of the range may leave a handful of rates that correlate by chance.
  const double share = options.min_overlap * static_cast<double>(grid.covered);
  grid.needed = std::max(fewest, static_cast<std::size_t>(share));
  for (Candidate& c : grid.candidates) {
    if (c.pairs < grid.needed) c.score = -1;
  }
  return grid;
}

/// The grid's local maxima, best first, at most `count`.
std::vector<Candidate> coarseMaxima(const std::vector<Candidate>& grid, std::size_t count) {
  std::vector<Candidate> maxima;
  for (std::size_t k = 1; k + 1 < grid.size(); ++k) {
    if (grid[k].score < 0) continue;
    if (grid[k].score >= grid[k - 1].score && grid[k].score > grid[k + 1].score) {
      maxima.push_back(grid[k]);
    }
  }
  std::ranges::sort(maxima, {}, [](const Candidate& c) { return std::pair(-c.score, c.offset_s); });
  if (maxima.empty()) {  // no motion: every offset is as good
    const auto best = std::ranges::max_element(grid, {}, &Candidate::score);
    if (best->score >= 0) maxima.push_back(*best);
  }
  if (maxima.size() > count) maxima.resize(count);
  return maxima;
}

Candidate refine(std::span<const CameraRate> camera, const GyroIntegral& gyro, Candidate c,
                 double step_s, std::size_t min_pairs) {
  // The peak is as wide as the motion is slow, and the last step, 0.03 of the first, is what noise
  // lets the parabola resolve.
  double h = step_s;
  for (int round = 0; round < 4; ++round, h *= 0.3) {
    const double below = scoreAt(camera, gyro, c.offset_s - h, min_pairs).score;
    const double above = scoreAt(camera, gyro, c.offset_s + h, min_pairs).score;
    if (below < 0 || above < 0) break;
    const double x = parabolaVertex(c.offset_s, h, below, c.score, above);
    const Candidate at = scoreAt(camera, gyro, x, min_pairs);
    if (at.score > c.score) c = at;
  }
  return c;
}

Failure notCovered(std::span<const CameraRate> camera, const GyroIntegral& gyro, const Grid& grid,
                   const TimeOffsetOptions& options) {
  const TimeNs start = camera.front().from;
  const auto seconds = [&](TimeNs t) { return secondsBetween(start, t); };
  Failure failure{FailureCode::kImuDoesNotCover,
                  {{"covered", grid.covered},
                   {"intervals", camera.size()},
                   {"needed", grid.needed},
                   {"range_s", options.max_offset_s},
                   {"frames_to_s", seconds(camera.back().to)}}};
  if (!gyro.samples().empty()) {
    failure.values.emplace("samples_from_s", seconds(gyro.samples().front().t));
    failure.values.emplace("samples_to_s", seconds(gyro.samples().back().t));
  }
  return failure;
}

/// Standard deviation of an offset that moves the gyroscope's rates along their slopes, by what the
/// alignment leaves of them: s / sqrt(sum |slope|^2), s^2 the mean square left, rotation and bias
/// taken as known. 1 s where nothing moves.
double offsetStd(std::span<const CameraRate> camera, const GyroIntegral& gyro,
                 const TimeOffsetEstimate& estimate) {
  constexpr double kApart = 0.01;      // [s] of the rates that give a slope
  constexpr double kRateUnknowns = 7;  // rotation, bias and the offset
  double squares = 0, slopes = 0, count = -kRateUnknowns;
  const RateAlignment& a = estimate.alignment;
  for (const CameraRate& c : camera) {
    const auto at = gyro.meanRateSlope(c.from, c.to, estimate.offset_s, kApart);
    if (!at) continue;
    squares += (at->rate - a.R_SC0 * c.rate_C - a.gyro_bias).squaredNorm();
    slopes += at->slope.squaredNorm();
    count += 3;
  }
  return slopes > 0 && count > 0 ? std::sqrt(squares / count / slopes) : 1;
}

}  // namespace

RateAlignment alignRates(std::span<const RatePair> pairs) {
  RateAlignment out;
  out.pairs = static_cast<int>(pairs.size());
  if (pairs.size() < 3) return out;
  const Moments m = momentsOf(pairs);
  const double scale = std::sqrt(m.gyro.trace() * m.camera);
  if (!(scale > 0)) return out;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  // Kabsch: the best rotation has det +1; where the best orthogonal matrix is a reflection, the
  // axis of the least singular value is turned round, and the sum loses it twice.
  const double hand = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const double same = s.sum() / scale;
  const double other = (s(0) + s(1) - s(2)) / scale;
  out.R_SC0 = svd.matrixU() * Eigen::Vector3d(1, 1, hand).asDiagonal() * svd.matrixV().transpose();
  out.correlation = hand > 0 ? same : other;
  out.mirrored_correlation = hand > 0 ? other : same;
  // The constant of the least squares, whatever the rotation is: it takes the mean residual away.
  out.gyro_bias = m.mean_gyro - out.R_SC0 * m.mean_camera;
  out.gyro_to_camera = std::sqrt(m.gyro.trace() / m.camera);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(m.gyro);
  out.excitation = eigen.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
  out.excitation_axes = eigen.eigenvectors().rowwise().reverse();
  return out;
}

void TimeOffsetOptions::check() const {
  requireOption(max_offset_s > 0, "max_offset_s", max_offset_s, "a positive time");
  requireOption(coarse_step_s > 0 && coarse_step_s <= max_offset_s, "coarse_step_s", coarse_step_s,
                "a positive time within max_offset_s");
  requireWithin(0, 1, "min_overlap", min_overlap);
  requireOption(min_pairs >= 3, "min_pairs", min_pairs, "3 or more");
}

Result<TimeOffsetEstimate> estimateTimeOffset(std::span<const CameraRate> camera,
                                              const GyroIntegral& gyro,
                                              const TimeOffsetOptions& options) {
  options.check();
  if (camera.size() < static_cast<std::size_t>(options.min_pairs)) {
    return Failure{FailureCode::kTooFewRates,
                   {{"rates", camera.size()}, {"needed", options.min_pairs}}};
  }
  const Grid grid = coarseGrid(camera, gyro, options);
  Candidate best;
  // A periodic motion correlates at several offsets; on the grid the wrong one may lead.
  for (const Candidate& c : coarseMaxima(grid.candidates, 5)) {
    const Candidate refined = refine(camera, gyro, c, options.coarse_step_s, grid.needed);
    if (refined.score > best.score) best = refined;
  }
  if (best.score < 0) return notCovered(camera, gyro, grid, options);
  TimeOffsetEstimate out;
  out.offset_s = best.offset_s;
  out.at_edge = std::abs(best.offset_s) > options.max_offset_s ||
                std::max(grid.candidates.front().score, grid.candidates.back().score) >= best.score;
  out.alignment = alignRates(pairRates(camera, gyro, best.offset_s));
  return out;
}

std::optional<PartOffsets> offsetsOfParts(std::span<const CameraRate> camera,
                                          const GyroIntegral& gyro, double offset_s) {
  constexpr std::size_t kMostParts = 10;
  constexpr std::size_t kRates = 30;  // of a part: seven unknowns are taken from them
  constexpr double kCorrelated = 0.95;
  constexpr double kSameRotation = 0.1;  // [rad]
  const std::size_t parts = std::min(kMostParts, camera.size() / kRates);
  // The search is about the whole recording's offset, however large that is: rates are moved by it,
  // and what the parts find is what they differ by.
  std::vector<CameraRate> shifted(camera.begin(), camera.end());
  for (CameraRate& rate : shifted) {
    rate.from += toNanoseconds(offset_s);
    rate.to += toNanoseconds(offset_s);
  }
  TimeOffsetOptions options;
  options.max_offset_s = 0.5;
  options.min_pairs = 10;
  struct Part {
    TimeOffsetEstimate estimate;
    double std_s = 0;
  };
  std::vector<Part> found;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = k * shifted.size() / parts;
    const std::size_t to = (k + 1) * shifted.size() / parts;
    const std::span<const CameraRate> part(shifted.data() + from, to - from);
    const auto estimate = estimateTimeOffset(part, gyro, options);
    if (!estimate || estimate->alignment.correlation < kCorrelated) continue;
    found.push_back({*estimate, offsetStd(part, gyro, *estimate)});
  }
  if (found.empty()) return std::nullopt;
  // Short parts of any two motions correlate under some rotation; those of one share it.
  const Part& best = *std::ranges::max_element(
      found, {}, [](const Part& part) { return part.estimate.alignment.correlation; });
  std::erase_if(found, [turn = best.estimate.alignment.R_SC0](const Part& part) {
    return logSO3(turn.transpose() * part.estimate.alignment.R_SC0).norm() > kSameRotation;
  });
  if (2 * found.size() < parts) return std::nullopt;
  PartOffsets out;
  double most = -1;
  // The pair that differs most in its own deviations, not in seconds.
  for (const Part& a : found) {
    for (const Part& b : found) {
      const double difference = b.estimate.offset_s - a.estimate.offset_s;
      const double std_s = std::hypot(a.std_s, b.std_s);
      if (!(difference >= 0 && difference > most * std_s)) continue;
      most = difference / std_s;
      out = {offset_s + a.estimate.offset_s, offset_s + b.estimate.offset_s, std_s};
    }
  }
  return out;
}

}  // namespace plumbline
