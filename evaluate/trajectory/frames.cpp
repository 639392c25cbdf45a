// SPDX-License-Identifier: BSD-3-Clause

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/hand_eye.h"
#include "evaluate/trajectory/evaluate_trajectory.h"
#include "evaluate/trajectory/remarks.h"

namespace plumbline {
namespace {

/// The search is about the offset that was given: the estimate's stamps are shifted by it first,
/// and what is found then adds to it.
Result<ClockOffsetRecord> clockOffsetOf(const Trajectory& estimate, const Trajectory& truth,
                                        const TrajectoryMetricOptions& options) {
  const double first = options.association.time_offset_s;
  std::vector<StampedPose> poses = estimate.poses;
  for (StampedPose& pose : poses) pose.t += toNanoseconds(first);
  const auto clock = estimateClockOffset(poses, truth.poses, *options.clock);
  if (!clock) return clock.failure();
  return ClockOffsetRecord{first + clock->offset_s, clock->std_s, clock->correlation,
                           clock->feature == RateFeature::kMagnitudes};
}

std::string clockRemark(const ClockOffsetRecord& clock) {
  std::string remark = fmt::format(
      "clock offset from angular rates: t_truth = t_estimate {:+.6f} s, std {:.6f} s, correlation "
      "{:.4f}",
      clock.offset_s, clock.std_s, clock.correlation);
  if (clock.magnitudes) {
    remark +=
        " of magnitudes; no constant rotation aligns the vectors, so the quaternions of one side "
        "are probably inverted or in another order";
  }
  return remark;
}

/// W and S are the estimate's world and body, V and M the truth's.
std::vector<HandEyePair> handEyePairs(const std::vector<PosePair>& pairs) {
  std::vector<HandEyePair> result;
  result.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    result.push_back({pair.estimate.transform(), pair.truth.transform()});
  }
  return result;
}

/// The first six of the state are T_SM's tangent [m, rad].
HandEyeRecord recordOf(const HandEye& found) {
  HandEyeRecord record;
  record.T_SM = found.state.T_SM;
  record.T_SM_covariance = found.covariance.topLeftCorner<6, 6>();
  record.T_SM_std = record.T_SM_covariance.diagonal().cwiseSqrt();
  record.T_VW = found.state.T_VW;
  record.rms_translation_m = found.rms_translation_m;
  record.rms_rotation_rad = found.rms_rotation_rad;
  return record;
}

Result<HandEyeRecord> handEyeOf(const Trajectory& estimate, const Trajectory& truth,
                                const TrajectoryMetricOptions& options, double time_offset_s) {
  // A pairing of nearest stamps would put |v| dt into every residual, which hand-eye takes for
  // noise.
  AssociationOptions at_stamps = options.association;
  at_stamps.rule = AssociationRule::kInterpolate;
  at_stamps.time_offset_s = time_offset_s;
  const Association association = associate(estimate, truth, at_stamps);
  // Said here, where the cause is known: hand-eye itself would report rotations that do not agree.
  if (const auto fault = explainQuaternionOrder(association.pairs)) return *fault;
  const auto found = estimateHandEye(handEyePairs(association.pairs));
  if (!found) return found.failure();
  return recordOf(*found);
}

/// The deviation with what an uncertain clock offset adds: `later` is the same under an offset that
/// is one of its deviations larger. On a way with few turns it is the larger part, for a clock that
/// is off moves the truth along its way.
HandEyeRecord withClock(HandEyeRecord record, const HandEyeRecord& later) {
  const Vector6d moved = boxminus(later.T_SM, record.T_SM);
  record.T_SM_covariance += moved * moved.transpose();
  record.T_SM_std = record.T_SM_covariance.diagonal().cwiseSqrt();
  return record;
}

std::string handEyeRemark(const HandEyeRecord& r) {
  const Eigen::Vector3d& t = r.T_SM.t;
  const Vector6d& s = r.T_SM_std;
  return fmt::format(
      "the truth is moved to the estimate's body by hand-eye: marker body at [{:.4f}, {:.4f}, "
      "{:.4f}] m, std [{:.2g}, {:.2g}, {:.2g}] m, turned {:.2f} deg, std {:.2g} deg; {:.4f} m and "
      "{:.3f} deg (RMS) remain. The std assumes white errors; drift makes it too small",
      t.x(), t.y(), t.z(), s[0], s[1], s[2], kDegrees * rotationAngle(r.T_SM.R),
      kDegrees * s.tail<3>().norm(), r.rms_translation_m, kDegrees * r.rms_rotation_rad);
}

/// T_VS = T_VM T_SM^-1: positions change by the lever arm in the marker's attitude of the moment.
Trajectory movedToS(Trajectory truth, const Transform& T_SM) {
  const Transform T_MS = T_SM.inverse();
  for (StampedPose& pose : truth.poses) {
    const Transform T_VS = pose.transform() * T_MS;
    pose.p = T_VS.t;
    pose.q = T_VS.quaternion();
  }
  return truth;
}

}  // namespace

Result<CommonFrames> commonFrames(const Trajectory& estimate, const Trajectory& truth,
                                  const TrajectoryMetricOptions& options) {
  CommonFrames frames;
  frames.time_offset_s = options.association.time_offset_s;
  if (!options.clock && !options.hand_eye) return frames;
  // Angular rates and hand-eye are of rotations; positions alone show neither.
  if (!estimate.has_orientation || !truth.has_orientation) {
    return Failure{FailureCode::kNoOrientations};
  }
  if (options.clock) {
    const auto clock = clockOffsetOf(estimate, truth, options);
    if (!clock) return clock.failure();
    frames.clock_offset = *clock;
    frames.time_offset_s = clock->offset_s;
    frames.remarks.push_back(clockRemark(*clock));
  }
  if (!options.hand_eye) return frames;
  // The lever arm is in metres, and so are the residuals that it is fitted to.
  if (scaleIsUnknown(options.alignment.kind)) {
    return Failure{FailureCode::kScaleUnknown, {{"alignment", toString(options.alignment.kind)}}};
  }
  const auto hand_eye = handEyeOf(estimate, truth, options, frames.time_offset_s);
  if (!hand_eye) return hand_eye.failure();
  frames.hand_eye = *hand_eye;
  if (frames.clock_offset) {
    const auto later =
        handEyeOf(estimate, truth, options, frames.time_offset_s + frames.clock_offset->std_s);
    if (later) frames.hand_eye = withClock(*hand_eye, *later);
  }
  frames.truth_S = movedToS(truth, hand_eye->T_SM);
  frames.remarks.push_back(handEyeRemark(*frames.hand_eye));
  return frames;
}

}  // namespace plumbline
