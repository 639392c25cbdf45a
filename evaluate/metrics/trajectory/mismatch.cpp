// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/mismatch.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "calibrator/base/time.h"
#include "evaluate/metrics/trajectory/errors.h"

namespace plumbline {
namespace {

constexpr double kFarBetter = 0.5;       // ATE with, as a share of that without
constexpr double kOwnScale = 1.25;       // up to it, and to its inverse, a scale is an error
constexpr double kExplainsTruth = 0.1;   // ATE as a share of the truth's spread
constexpr double kLeastExplained = 0.1;  // of the squared errors, by a shift in time
constexpr double kMostOffset = 2;        // [s]
constexpr double kSettled = 1e-4;        // a step that changes nothing more [s]
constexpr double kLeastOffset = 1e-3;    // [s]
constexpr double kWidestInterval = 0.5;  // over which a velocity is taken [s]
constexpr int kMostSteps = 20;

/// Positions in the truth's frame, after an alignment by all pairs.
struct Aligned {
  AlignedPoses poses;
  double scale = 1;
  double ate_m = std::numeric_limits<double>::quiet_NaN();
};

std::optional<Aligned> alignedBy(const std::vector<PosePair>& pairs, AlignmentKind kind) {
  const Result<AlignmentRecord> alignment = align(pairs, {kind});
  if (!alignment) return std::nullopt;
  Aligned aligned{alignedPoses(pairs, *alignment), alignment->scale};
  double sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sum += (aligned.poses.truth[i].t - aligned.poses.estimate[i].t).squaredNorm();
  }
  aligned.ate_m = std::sqrt(sum / static_cast<double>(pairs.size()));
  return aligned;
}

std::vector<Eigen::Vector3d> positionsOf(const std::vector<Transform>& poses) {
  std::vector<Eigen::Vector3d> positions;
  for (const Transform& pose : poses) positions.push_back(pose.t);
  return positions;
}

/// A step of the offset, and the share of the squared errors that it explains to first order.
struct Step {
  double offset_s = 0;
  double explained = 0;
};

Step stepOf(const std::vector<PosePair>& pairs, const AlignedPoses& poses) {
  double ev = 0, vv = 0, ee = 0;
  for (std::size_t i = 1; i + 1 < pairs.size(); ++i) {
    const double interval = secondsBetween(pairs[i - 1].truth.t, pairs[i + 1].truth.t);
    if (!(interval > 0 && interval <= kWidestInterval)) continue;
    const Eigen::Vector3d v = (poses.truth[i + 1].t - poses.truth[i - 1].t) / interval;
    const double dt = secondsBetween(pairs[i].estimate.t, pairs[i].truth.t);
    const Eigen::Vector3d e = poses.truth[i].t - poses.estimate[i].t - v * dt;
    ev += e.dot(v);
    vv += v.squaredNorm();
    ee += e.squaredNorm();
  }
  if (!(vv > 0 && ee > 0)) return {};
  return {-ev / vv, ev * ev / (vv * ee)};
}

}  // namespace

std::optional<ScaleMismatch> scaleMismatch(const std::vector<PosePair>& pairs) {
  const auto as_is = alignedBy(pairs, AlignmentKind::kSe3);
  const auto scaled = alignedBy(pairs, AlignmentKind::kSim3);
  if (!as_is || !scaled) return std::nullopt;
  const double s = scaled->scale;
  if (!(s > kOwnScale || s < 1 / kOwnScale)) return std::nullopt;
  if (!(scaled->ate_m <= kFarBetter * as_is->ate_m)) return std::nullopt;
  if (!(scaled->ate_m <= kExplainsTruth * spreadOf(positionsOf(scaled->poses.truth))))
    return std::nullopt;
  return ScaleMismatch{s, as_is->ate_m, scaled->ate_m};
}

std::optional<ClockMismatch> clockMismatch(const Trajectory& estimate, const Trajectory& truth,
                                           const std::vector<PosePair>& pairs,
                                           const AssociationOptions& options, AlignmentKind kind) {
  const auto as_is = alignedBy(pairs, kind);
  if (!as_is) return std::nullopt;
  Step step = stepOf(pairs, as_is->poses);
  if (!(step.explained >= kLeastExplained)) return std::nullopt;
  double offset_s = 0;
  double ate_m = as_is->ate_m;
  for (int i = 0; std::abs(step.offset_s) > kSettled; ++i) {
    offset_s += step.offset_s;
    if (i == kMostSteps || !(std::abs(offset_s) <= kMostOffset)) return std::nullopt;
    AssociationOptions moved = options;
    moved.time_offset_s += offset_s;
    const std::vector<PosePair> anew = associate(estimate, truth, moved).pairs;
    if (2 * anew.size() < pairs.size()) return std::nullopt;
    const auto aligned = alignedBy(anew, kind);
    if (!aligned) return std::nullopt;
    ate_m = aligned->ate_m;
    step = stepOf(anew, aligned->poses);
  }
  if (!(std::abs(offset_s) >= kLeastOffset && ate_m <= kFarBetter * as_is->ate_m)) {
    return std::nullopt;
  }
  return ClockMismatch{options.time_offset_s + offset_s, offset_s, as_is->ate_m, ate_m};
}

}  // namespace plumbline
