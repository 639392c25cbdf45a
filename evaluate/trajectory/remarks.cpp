// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/remarks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/errors.h"
#include "evaluate/metrics/trajectory/mismatch.h"
#include "evaluate/metrics/trajectory/quaternion_order.h"

namespace plumbline {
namespace {

struct Span {
  double from = 0, to = 0;  // [s]
};

/// In doubles of seconds: for messages alone.
Span spanOf(const Trajectory& trajectory, double offset_s) {
  return {static_cast<double>(trajectory.poses.front().t) * 1e-9 + offset_s,
          static_cast<double>(trajectory.poses.back().t) * 1e-9 + offset_s};
}

/// The difference of stamps [s] of the pair that is closest, signed, estimate - truth. evo's rule
/// with a limit that excludes nothing looks up the nearest for each pose without listing all pairs.
double nearestDt(const Trajectory& estimate, const Trajectory& truth, double offset_s) {
  AssociationOptions wide;
  wide.rule = AssociationRule::kEvo;
  wide.max_dt_s = 1e9;
  wide.time_offset_s = offset_s;
  double nearest = std::numeric_limits<double>::infinity();
  for (const PosePair& pair : associate(estimate, truth, wide).pairs) {
    // The sign is kept for the reader: which of the two clocks is ahead.
    const double dt = secondsBetween(pair.truth.t, pair.estimate.t);
    if (std::abs(dt) < std::abs(nearest)) nearest = dt;
  }
  return nearest;
}

/// Pairs are in the order of the estimate and stamps do not descend, so that a pose used again
/// stands next to its first use.
std::size_t usedTwice(const std::vector<PosePair>& pairs) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const bool truth = pairs[i].truth.t == pairs[i - 1].truth.t;
    const bool estimate = pairs[i].estimate.t == pairs[i - 1].estimate.t;
    if (truth || estimate) ++count;
  }
  return count;
}

/// Of the poses of a denser truth the nearest is up to half an interval off, whatever the clocks
/// are: it is then the distance of two grids of stamps.
bool isLeftByGrid(double median_dt_s, const Trajectory& estimate, const Trajectory& truth) {
  const double interval = usualInterval(truth.poses);
  return 2 * interval <= usualInterval(estimate.poses) && 2 * std::abs(median_dt_s) <= interval;
}

const char* whose(bool truth, bool estimate) {
  return !truth ? "estimate" : estimate ? "truth or of the estimate" : "truth";
}

/// A constant rotation of the world behind the alignment, that the orientations ask for.
struct WorldRotation {
  double spread_deg = 0;  ///< median angle that it leaves
  double fitted_m = 0;    ///< RMS of the positions, as they were aligned
  double turned_m = 0;    ///< and turned by it about their mean
};

WorldRotation worldRotation(const AlignedPoses& poses, const AlignmentRecord& alignment) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_truth = Eigen::Vector3d::Zero(), mean_estimate = Eigen::Vector3d::Zero();
  const auto n = static_cast<double>(poses.truth.size());
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    sum += poses.truth[i].R * poses.estimate[i].R.transpose();
    mean_truth += poses.truth[i].t / n;
    mean_estimate += poses.estimate[i].t / n;
  }
  Eigen::Matrix3d R = nearestRotation(sum);
  if (alignment.kind == toString(AlignmentKind::kYaw)) {
    // That fit leaves no tilt free: a tilt is the estimate's own error.
    const double yaw = std::atan2(sum(1, 0) - sum(0, 1), sum(0, 0) + sum(1, 1));
    R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  WorldRotation world;
  std::vector<double> angles;
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    const Transform& truth = poses.truth[i];
    const Transform& estimate = poses.estimate[i];
    angles.push_back(kDegrees * rotationAngle(truth.R.transpose() * R * estimate.R));
    const Eigen::Vector3d y = truth.t - mean_truth, x = estimate.t - mean_estimate;
    world.fitted_m += (y - x).squaredNorm() / n;
    world.turned_m += (y - R * x).squaredNorm() / n;
  }
  world.spread_deg = sampleStatistics(std::move(angles)).median;
  world.fitted_m = std::sqrt(world.fitted_m);
  world.turned_m = std::sqrt(world.turned_m);
  return world;
}

constexpr double kNoticeableOffset = 1e-3;  // [s]
constexpr double kManyWithout = 0.05;       // of the estimate's poses
constexpr double kOtherBodyDeg = 15;        // after alignment, more than an estimator errs
constexpr double kRigidDeg = 5;             // spread about a constant rotation that is believed
constexpr double kHardlyWorse = 2;          // of positions, as far as a fit's rotation leaves free

}  // namespace

Failure explainTooFewPairs(const Trajectory& estimate, const Trajectory& truth,
                           const Association& association, const AssociationOptions& options) {
  // As they were compared, the estimate's with the offset that was given.
  const Span a = spanOf(estimate, options.time_offset_s);
  const Span b = spanOf(truth, 0);
  if (a.to < b.from || b.to < a.from) {
    return {FailureCode::kNoCommonTime,
            {{"estimate_from_s", a.from},
             {"estimate_to_s", a.to},
             {"truth_from_s", b.from},
             {"truth_to_s", b.to},
             {"given_s", options.time_offset_s}}};
  }
  Failure failure{FailureCode::kTooFewPartners,
                  {{"pairs", association.pairs.size()},
                   {"poses", estimate.poses.size()},
                   {"truth", truth.poses.size()}}};
  // Interpolation has no largest difference; what keeps poses apart from the truth are its gaps.
  if (options.rule == AssociationRule::kInterpolate) {
    failure.code = FailureCode::kPartnersInGaps;
    failure.values.emplace("in_gaps", association.record.stamps_in_gaps);
    failure.values.emplace("max_gap_s", options.max_gap_s);
    return failure;
  }
  failure.values.emplace("max_dt_s", options.max_dt_s);
  failure.values.emplace("nearest_s", nearestDt(estimate, truth, options.time_offset_s));
  return failure;
}

std::vector<std::string> remarksOn(const Association& association, const Trajectory& estimate,
                                   const Trajectory& truth, bool clock_is_known) {
  const AssociationRecord& r = association.record;
  std::vector<std::string> remarks;
  // Signed, so that scatter of the stamps cancels and a clock's offset stays.
  if (std::abs(r.median_dt_s) > kNoticeableOffset) {
    const bool of_grid = clock_is_known || isLeftByGrid(r.median_dt_s, estimate, truth);
    remarks.push_back(fmt::format(
        "the paired stamps differ by {:+.3f} ms in the median (estimate - truth): {}; "
        "compare with --association interpolate",
        1e3 * r.median_dt_s,
        of_grid ? "the truth has no poses at the estimate's stamps" : "perhaps a clock offset"));
  }
  if (r.stamps_in_gaps > 0) {
    remarks.push_back(fmt::format("{} estimated poses lie in gaps of the truth and are not used",
                                  r.stamps_in_gaps));
  }
  // An estimate with more poses than the truth cannot have a partner for each: that is no remark.
  const std::size_t without = r.estimate_poses - std::min(r.matches, r.estimate_poses);
  if (static_cast<double>(without) > kManyWithout * static_cast<double>(r.estimate_poses) &&
      r.estimate_poses <= r.truth_poses) {
    remarks.push_back(
        fmt::format("{} of {} estimated poses have no matching truth and are not evaluated",
                    without, r.estimate_poses));
  }
  if (r.rule == toString(AssociationRule::kEvo)) {
    const std::size_t twice = usedTwice(association.pairs);
    if (twice > 0) {
      remarks.push_back(fmt::format(
          "evo's rule used {} poses twice: their errors count twice; one-to-one does not", twice));
    }
  }
  return remarks;
}

bool isFit(const AlignmentRecord& alignment) {
  return alignment.kind == toString(AlignmentKind::kSe3) ||
         alignment.kind == toString(AlignmentKind::kSim3) ||
         alignment.kind == toString(AlignmentKind::kYaw);
}

RotationRemark remarkOnRotations(const std::vector<PosePair>& pairs,
                                 const AlignmentRecord& alignment, AlignmentKind kind) {
  const AlignedPoses poses = alignedPoses(pairs, alignment);
  const double median =
      sampleStatistics(absoluteErrors(poses, AbsoluteMeasure::kRotationDeg)).median;
  if (pairs.empty() || median < kOtherBodyDeg) return {};
  const Eigen::Matrix3d& R = alignment.T_truth_estimate.R;
  const std::string start =
      fmt::format("the rotations differ by {:.1f} deg in the median, ", median);
  const WorldRotation world = worldRotation(poses, alignment);
  if (isFit(alignment) && world.spread_deg < kRigidDeg &&
      world.turned_m < kHardlyWorse * world.fitted_m) {
    return {start + fmt::format("as one constant rotation of the world would explain, which the "
                                "positions hardly determine: their RMS error is {:.3g} m with it "
                                "and {:.3g} m as aligned",
                                world.turned_m, world.fitted_m),
            kind == AlignmentKind::kYaw ? "--align yaw-first" : "--align se3-first", true};
  }
  // Three readings of the same rotations: as they are, and with those of either side inverted.
  const BodyRotation as_read = bodyRotation(poses, R, false, false);
  const double truth_deg = bodyRotation(poses, R, true, false).spread_deg;
  const double estimate_deg = bodyRotation(poses, R, false, true).spread_deg;
  if (as_read.spread_deg < kRigidDeg) {
    // The origins of the bodies differ as well where one is a camera's and one an IMU's.
    return {start + fmt::format("as a rotation of {:.1f} deg between the body frames would explain "
                                "(camera and IMU?); position errors include the lever arm between "
                                "the bodies, if there is one",
                                as_read.angle_deg),
            scaleIsUnknown(kind) ? "--align se3 --hand-eye auto" : "--hand-eye auto"};
  }
  if (std::min(truth_deg, estimate_deg) >= kRigidDeg) {
    return {start + "and no constant rotation of the body explains it", ""};
  }
  // Both where the two worlds coincide: positions then cannot tell whose quaternions are right.
  const bool truth = truth_deg < kRigidDeg, estimate = estimate_deg < kRigidDeg;
  return {start + fmt::format("but by {:.1f} deg if the quaternions of the {} are inverted: they "
                              "probably map the world into the body, even if the header states "
                              "otherwise",
                              std::min(truth_deg, estimate_deg), whose(truth, estimate)),
          truth && estimate ? "--truth-inverted or --estimate-inverted"
          : truth           ? "--truth-inverted"
                            : "--estimate-inverted"};
}

std::string remarkOnReading(const std::vector<PosePair>& pairs, bool with_rotation) {
  const auto mismatch = readingMismatch(pairs, with_rotation);
  if (!mismatch) return "";
  const auto [reading, ate_m, other_ate_m] = *mismatch;
  if (reading == PoseReading::kMirrored) {
    return fmt::format(
        "the RMSE is {:.3g} m (after se3), but {:.3g} m where the estimate is "
        "mirrored: one of the two has a left-handed world; convert its file",
        ate_m, other_ate_m);
  }
  return fmt::format(
      "the RMSE is {:.3g} m (after se3), but {:.3g} m where all poses of the {} are "
      "inverted: its file probably maps the world into the body (T_CW); invert its "
      "poses, positions included",
      ate_m, other_ate_m, reading == PoseReading::kTruthInverted ? "truth" : "estimate");
}

std::optional<Failure> explainQuaternionOrder(const std::vector<PosePair>& pairs) {
  const auto fault = quaternionOrderFault(pairs);
  if (!fault) return std::nullopt;
  return Failure{FailureCode::kQuaternionsWFirst,
                 {{"which", whose(fault->truth, fault->estimate)},
                  {"as_read_deg", fault->as_read_deg},
                  {"reordered_deg", fault->reordered_deg}}};
}

}  // namespace plumbline
