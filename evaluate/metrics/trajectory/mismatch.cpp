// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/mismatch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/time.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/initialise/clock_offset.h"
#include "evaluate/metrics/trajectory/errors.h"

namespace plumbline {
namespace {

constexpr double kOwnScale = 1.25;       // up to it, and to its inverse, a scale is an error
constexpr double kAgrees = 0.01;         // ATE as a share of the truth's spread: nothing to explain
constexpr double kExplainsTruth = 0.1;   // ATE as a share of the truth's spread
constexpr double kLeastExplained = 0.1;  // of the squared errors, by a shift in time
constexpr double kMostOffset = 2;        // [s]
constexpr double kSettled = 1e-4;        // a step that changes nothing more [s]
constexpr double kLeastHalf = 0.02;      // of the interval over which a velocity is taken [s]
constexpr double kBridged = 3;           // usual intervals of the truth, whatever gap is allowed
constexpr double kHidden = 1e-6;         // share of v^T v that no alignment can take, at least
constexpr double kConfirmed = 0.25;      // of the positions' offset, by the rates
constexpr int kMostSteps = 20;

/// Positions in the truth's frame, after an alignment by all pairs.
struct Aligned {
  AlignedPoses poses;
  double scale = 1;
  double ate_m = 0;
};

std::optional<Aligned> alignedBy(const std::vector<PosePair>& pairs, AlignmentKind kind) {
  const Result<AlignmentRecord> alignment = align(pairs, {kind});
  if (!alignment) return std::nullopt;
  Aligned aligned{alignedPoses(pairs, *alignment), alignment->scale};
  aligned.ate_m =
      sampleStatistics(absoluteErrors(aligned.poses, AbsoluteMeasure::kTranslation)).rmse;
  return aligned;
}

std::vector<Eigen::Vector3d> positionsOf(const std::vector<Transform>& poses) {
  std::vector<Eigen::Vector3d> positions;
  for (const Transform& pose : poses) positions.push_back(pose.t);
  return positions;
}

void invert(StampedPose& pose) {
  const Transform inverse = pose.transform().inverse();
  pose.p = inverse.t;
  pose.q = inverse.quaternion();
}

std::vector<PosePair> readAs(std::vector<PosePair> pairs, PoseReading reading) {
  for (PosePair& pair : pairs) {
    if (reading == PoseReading::kMirrored) pair.estimate.p.z() *= -1;
    if (reading == PoseReading::kEstimateInverted) invert(pair.estimate);
    if (reading == PoseReading::kTruthInverted) invert(pair.truth);
  }
  return pairs;
}

/// The two trajectories by an offset in addition to the one that was given.
class ClockTrial {
 public:
  ClockTrial(const Trajectory& estimate, const Trajectory& truth, const ClockTrialOptions& options)
      : estimate_(estimate), truth_(truth), options_(options) {
    const double usual = usualInterval(truth.poses);
    max_gap_s_ = std::max(options.max_gap_s, kBridged * usual);
    half_s_ = std::max(kLeastHalf, usual);
  }

  Association at(double offset_s) const {
    AssociationOptions how;
    how.rule = AssociationRule::kInterpolate;
    how.max_gap_s = max_gap_s_;
    how.time_offset_s = options_.time_offset_s + offset_s;
    return associate(estimate_, truth_, how);
  }

  std::optional<Aligned> aligned(const std::vector<PosePair>& pairs) const {
    return alignedBy(pairs, options_.alignment);
  }

  /// A step of the offset, and the share of the squared errors that it explains to first order.
  struct Step {
    double offset_s = 0, explained = 0;
  };
  Step stepOf(const std::vector<PosePair>& pairs, const AlignedPoses& poses) const {
    Eigen::Matrix<double, 7, 7> N = Eigen::Matrix<double, 7, 7>::Zero();  // of the alignment
    Eigen::Matrix<double, 7, 1> Jv = Eigen::Matrix<double, 7, 1>::Zero();
    const Eigen::Vector3d middle = meanOf(positionsOf(poses.estimate));
    double ev = 0, vv = 0, ee = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto v = velocityAt(pairs[i].truth.t);
      if (!v) continue;
      const Eigen::Vector3d e = poses.truth[i].t - poses.estimate[i].t;
      const Eigen::Vector3d p = poses.estimate[i].t - middle;
      Eigen::Matrix<double, 3, 7> J;
      J << -skew(p), Eigen::Matrix3d::Identity(), p;
      if (options_.alignment != AlignmentKind::kSim3) J.col(6).setZero();
      N += J.transpose() * J;
      Jv += J.transpose() * *v;
      ev += e.dot(*v);
      vv += v->squaredNorm();
      ee += e.squaredNorm();
    }
    if (options_.alignment != AlignmentKind::kSim3) N(6, 6) = 1;
    const double left = vv - SymmetricFactor(N).squaredNorm(Jv);  // of v, behind any alignment
    if (!(left > kHidden * vv && ee > 0)) return {};
    return {-ev / left, ev * ev / (left * ee)};
  }

 private:
  /// Of the truth, by its positions before and after.
  std::optional<Eigen::Vector3d> velocityAt(TimeNs t) const {
    const TimeNs half = toNanoseconds(half_s_), gap = toNanoseconds(max_gap_s_);
    const Interpolated before = poseAt(truth_.poses, t - half, gap);
    const Interpolated after = poseAt(truth_.poses, t + half, gap);
    if (!before.pose || !after.pose) return std::nullopt;
    return (after.pose->p - before.pose->p) / (2 * half_s_);
  }

  const Trajectory& estimate_;
  const Trajectory& truth_;
  ClockTrialOptions options_;
  double max_gap_s_ = 0, half_s_ = 0;
};

/// The pairs of `a` whose poses of the estimate have a partner in `b`, too.
std::vector<PosePair> inBoth(const Association& a, const Association& b) {
  std::vector<PosePair> pairs;
  std::size_t k = 0;  // both ascend
  for (std::size_t i = 0; i < a.pairs.size(); ++i) {
    while (k < b.estimate_index.size() && b.estimate_index[k] < a.estimate_index[i]) ++k;
    if (k == b.estimate_index.size()) break;
    if (b.estimate_index[k] == a.estimate_index[i]) pairs.push_back(a.pairs[i]);
  }
  return pairs;
}

/// The offset that the rates tell, in addition to the given one.
std::optional<double> ratesOffset(const Trajectory& estimate, const Trajectory& truth,
                                  double given_s) {
  if (!estimate.has_orientation || !truth.has_orientation) return std::nullopt;
  std::vector<StampedPose> poses = estimate.poses;
  for (StampedPose& pose : poses) pose.t += toNanoseconds(given_s);
  ClockOffsetOptions wide;
  wide.max_offset_s = kRatesRange;
  const auto found = estimateClockOffset(poses, truth.poses, wide);
  if (!found) return std::nullopt;
  return found->offset_s;
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

std::optional<ReadingMismatch> readingMismatch(const std::vector<PosePair>& pairs,
                                               bool with_rotation) {
  const auto as_read = alignedBy(pairs, AlignmentKind::kSe3);
  // An estimate that agrees is read as it should be.
  if (!as_read || as_read->ate_m <= kAgrees * spreadOf(positionsOf(as_read->poses.truth))) {
    return std::nullopt;
  }
  std::vector<PoseReading> readings{PoseReading::kMirrored};
  if (with_rotation) {
    readings.insert(readings.end(), {PoseReading::kEstimateInverted, PoseReading::kTruthInverted});
  }
  std::optional<ReadingMismatch> best;
  for (const PoseReading reading : readings) {
    const auto other = alignedBy(readAs(pairs, reading), AlignmentKind::kSe3);
    if (!other || !(other->ate_m <= kFarBetter * as_read->ate_m)) continue;
    const double spread = spreadOf(positionsOf(other->poses.truth));
    if (!(other->ate_m <= kExplainsTruth * spread)) continue;
    if (best && best->other_ate_m <= other->ate_m) continue;
    best = ReadingMismatch{reading, as_read->ate_m, other->ate_m};
  }
  return best;
}

std::optional<ClockMismatch> clockMismatch(const Trajectory& estimate, const Trajectory& truth,
                                           const ClockTrialOptions& options) {
  const ClockTrial trial(estimate, truth, options);
  const Association as_is = trial.at(0);
  const auto aligned = trial.aligned(as_is.pairs);
  if (!aligned) return std::nullopt;
  ClockTrial::Step step = trial.stepOf(as_is.pairs, aligned->poses);
  if (!(step.explained >= kLeastExplained)) return std::nullopt;
  double offset_s = 0;
  Association moved = as_is;
  for (int i = 0; std::abs(step.offset_s) > kSettled; ++i) {
    offset_s += step.offset_s;
    if (i == kMostSteps || !(std::abs(offset_s) <= kMostOffset)) return std::nullopt;
    moved = trial.at(offset_s);
    if (2 * moved.pairs.size() < as_is.pairs.size()) return std::nullopt;
    const auto anew = trial.aligned(moved.pairs);
    if (!anew) return std::nullopt;
    step = trial.stepOf(moved.pairs, anew->poses);
  }
  const auto before = trial.aligned(inBoth(as_is, moved));
  const auto after = trial.aligned(inBoth(moved, as_is));
  if (std::abs(offset_s) < kLeastOffset || !before || !after) return std::nullopt;
  if (!(after->ate_m <= kFarBetter * before->ate_m)) return std::nullopt;
  return ClockMismatch{options.time_offset_s,
                       offset_s,
                       ratesOffset(estimate, truth, options.time_offset_s),
                       toString(options.alignment),
                       before->ate_m,
                       after->ate_m};
}

std::optional<bool> ratesConfirm(const ClockMismatch& mismatch) {
  if (!mismatch.rates_s) return std::nullopt;
  return *mismatch.rates_s / mismatch.positions_s >= kConfirmed;
}

}  // namespace plumbline
