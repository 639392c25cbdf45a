// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"
#include "calibrator/fields/calibration_fields.h"

namespace plumbline {

/// How the stamps of estimate and truth were paired, and their anomalies.
struct AssociationRecord {
  std::string rule;
  double max_dt_s = 0;
  std::size_t matches = 0;
  std::size_t estimate_poses = 0, truth_poses = 0, estimate_duplicates = 0, truth_duplicates = 0;
  double median_dt_s = 0, largest_estimate_gap_s = 0, largest_truth_gap_s = 0, time_offset_s = 0;
  std::size_t stamps_in_gaps = 0;
};

/// All but the rule and the number of matches, which a run has at its top.
void fields(auto& v, AssociationRecord& r) {
  v("max_dt_s", r.max_dt_s, "s", "largest difference that pairs");
  v("time_offset_s", r.time_offset_s, "s", "added to the estimate's stamps before pairing");
  v("estimate_poses", r.estimate_poses, "1", "in the estimate");
  v("truth_poses", r.truth_poses, "1", "in the truth");
  v("estimate_duplicates", r.estimate_duplicates, "1", "poses whose stamp equals the one before");
  v("truth_duplicates", r.truth_duplicates, "1", "likewise");
  v("median_dt_s", r.median_dt_s, "s", "of the pairs, estimate - truth: shows a clock offset");
  v("largest_estimate_gap_s", r.largest_estimate_gap_s, "s", "between consecutive poses");
  v("largest_truth_gap_s", r.largest_truth_gap_s, "s", "likewise");
  v("stamps_in_gaps", r.stamps_in_gaps, "1", "`interpolate`: where the truth's gap was too wide");
}

/// p_truth = scale R p_estimate + t.
struct AlignmentRecord {
  std::string kind;  ///< "se3", "sim3", "scale", "yaw", "origin", "se3-first", "yaw-first", "none"
  int first_n = 0;
  double scale = 1;
  Transform T_truth_estimate;
};

/// Errors of relative motion over one distance.
struct RelativeErrorRecord {
  double delta = 0;
  std::string unit, pairs = "plumbline";
  SampleStatistics translation_m, rotation_deg;
};

void fields(auto& v, RelativeErrorRecord& r) {
  v("delta", r.delta, "distance in `unit`");
  v("unit", r.unit, "`frames`, `m`, `s`");
  v("pairs", r.pairs, "whose rule selected the pairs: `plumbline`, `evo`, `rpg`, ...");
  v("translation_m", r.translation_m, "m", "errors of the translation");
  v("rotation_deg", r.rotation_deg, "deg", "errors of the rotation");
}

/// t_truth = t_estimate + offset, from correlating angular rates.
struct ClockOffsetRecord {
  double offset_s = 0, std_s = 0, correlation = 0;
  bool magnitudes = false;
};

void fields(auto& v, ClockOffsetRecord& r) {
  v("offset_s", r.offset_s, "s", "t_truth = t_estimate + offset");
  v("std_s", r.std_s, "s", "its standard deviation");
  v("correlation", r.correlation, "1", "of the angular rates at the maximum, -1 to 1");
  v("magnitudes", r.magnitudes, "of the rates' magnitudes, since no rotation joined the bodies");
}

/// The marker body M in the IMU frame S, with the truth's world V and the estimate's world W.
struct HandEyeRecord {
  Transform T_SM;
  Vector6d T_SM_std = Vector6d::Zero();
  Matrix6d T_SM_covariance = Matrix6d::Zero();
  Transform T_VW;
  double rms_translation_m = 0, rms_rotation_rad = 0;
};

void fields(auto& v, HandEyeRecord& r) {
  v("T_SM", r.T_SM, "m", "the marker body in the IMU frame");
  v("T_SM_std", r.T_SM_std, "m, rad", "3 of the translation, 3 of the left tangent");
  v("T_SM_covariance", r.T_SM_covariance, "rows, tangent (dt, da) of Transform");
  v("T_VW", r.T_VW, "m", "the estimate's world in the truth's");
  v("rms_translation_m", r.rms_translation_m, "m", "of the residuals");
  v("rms_rotation_rad", r.rms_rotation_rad, "rad", "of the residuals");
}

/// What a mean NEES says of the covariances: above its bounds they are too small, below too large.
enum class NeesReading { kConsistent, kOverconfident, kCautious };
constexpr std::array<const char*, 3> enumWords(NeesReading /*of*/) {
  return {"consistent", "overconfident", "cautious"};
}

/// Mean normalised estimation error squared against its two-sided chi-square bounds.
struct NeesRecord {
  std::string part;
  int dof = 0;
  double mean = 0, lower = 0, upper = 0, confidence = 0.95;
  NeesReading reading = NeesReading::kConsistent;
};

void fields(auto& v, NeesRecord& r) {
  v("part", r.part, "`position`, `orientation`, `pose`");
  v("dof", r.dof, "of one pose");
  v("mean", r.mean, "1", "mean normalised estimation error squared");
  v("lower", r.lower, "1", "two-sided chi-square bound of the mean");
  v("upper", r.upper, "1", "likewise");
  v("confidence", r.confidence, "of the bounds");
  v("reading", r.reading, "`consistent`; `overconfident`: above the bounds; `cautious`: below");
}

/// How an odometry made an estimate.
struct OdometryRunRecord {
  std::string system;
  double seconds = 0, real_time_factor = 0;
  std::size_t frames = 0, frames_skipped = 0, losses = 0;
  double mean_landmarks = 0;
  std::vector<std::string> log;
  std::optional<double> stereo_px, innovation_px;  ///< of the built-in odometry
  std::optional<double> closure_m, closure_deg;
  std::optional<double> offset_hint_s, offset_hint_std_s, offset_calibrated_s;
  std::optional<Vector6d> T_SC0_hint, T_SC0_hint_std;
  std::optional<double> frame_p50_ms, frame_p95_ms, frame_p99_ms, frame_max_ms;
};

void fields(auto& v, OdometryRunRecord& r) {
  v("system", r.system, "`builtin`, or the runner's name");
  v("seconds", r.seconds, "s", "of wall time, images read included");
  v("real_time_factor", r.real_time_factor, "1", "recorded time / seconds");
  v("frames", r.frames, "1", "offered");
  v("frames_skipped", r.frames_skipped, "1", "missing or damaged");
  v("losses", r.losses, "1", "instants at which tracking was lost and restarted: a jump");
  v("mean_landmarks", r.mean_landmarks, "1", "landmarks per frame; 0: not known");
  v("stereo_px", r.stereo_px, "px", "median distance from the rig's epipolar lines");
  v("innovation_px", r.innovation_px, "px",
    "median error of observations where the IMU predicts them");
  v("closure_m", r.closure_m, "m", "from the first pose to the last");
  v("closure_deg", r.closure_deg, "deg", "likewise");
  v("offset_calibrated_s", r.offset_calibrated_s, "s", "time offset t_d that was used");
  v("offset_hint_s", r.offset_hint_s, "s", "t_d that the odometry prefers: a hint");
  v("offset_hint_std_s", r.offset_hint_std_s, "s",
    "its standard deviation; of another system: how much its online calibration still changed");
  v("T_SC0_hint", r.T_SC0_hint, "m, rad",
    "change of T_SC0 that it prefers: 3 of the translation, 3 of the left tangent");
  v("T_SC0_hint_std", r.T_SC0_hint_std, "m, rad", "its standard deviations, likewise");
  v("frame_p50_ms", r.frame_p50_ms, "ms", "time of a frame, image read included: median");
  v("frame_p95_ms", r.frame_p95_ms, "ms", "its 95th percentile");
  v("frame_p99_ms", r.frame_p99_ms, "ms", "its 99th percentile");
  v("frame_max_ms", r.frame_max_ms, "ms", "the longest");
  v.ifSet("log", r.log, "last lines of a system that failed");
}

/// Lengths that agree by another scale (scaleMismatch()).
struct ScaleMismatch {
  double scale = 1;
  double ate_m = 0, scaled_ate_m = 0;
};

void fields(auto& v, ScaleMismatch& m) {
  v("scale", m.scale, "1", "lengths of the truth / of the estimate, from sim3 over all pairs");
  v("ate_m", m.ate_m, "m", "RMSE of the positions as they are, after se3 over all pairs");
  v("scaled_ate_m", m.scaled_ate_m, "m", "with the scale");
}

/// Positions that agree by another offset of the clocks (clockMismatch()).
struct ClockMismatch {
  double given_s = 0, positions_s = 0;
  std::optional<double> rates_s;
  std::string alignment;
  double ate_m = 0, moved_ate_m = 0;
};

void fields(auto& v, ClockMismatch& m) {
  v("given_s", m.given_s, "s", "added to the estimate's stamps already");
  v("positions_s", m.positions_s, "s", "what the positions ask for besides: t_truth - t_estimate");
  v("rates_s", m.rates_s, "s", "what the angular rates ask for; absent where they do not tell");
  v("alignment", m.alignment,
    "`se3` or `sim3`, over all poses that are compared; with `and hand-eye anew` the offset of the "
    "angular rates was tried, with another hand-eye transform");
  v("ate_m", m.ate_m, "m", "RMSE of the positions by the stamps as they are, after it");
  v("moved_ate_m", m.moved_ate_m, "m", "with the positions' offset");
}

enum class RunStatus { kComplete, kPartial, kFailed };
constexpr std::array<const char*, 3> enumWords(RunStatus /*of*/) {
  return {"complete", "partial", "failed"};
}

/// One estimate against its truth.
struct TrajectoryRun {
  bool without_truth = false;
  std::string sequence, calibration, run, estimate, truth;
  RunStatus status = RunStatus::kComplete;
  std::string problem;
  std::vector<std::string> remarks;
  std::string left_out, cure;
  double coverage = 0, coverage_from_first_pose = 0;
  double starts_late_s = 0;  ///< negative: before the truth
  AssociationRecord association;
  AlignmentRecord alignment;
  SampleStatistics ate_translation_m, ate_rotation_deg;
  std::vector<RelativeErrorRecord> rpe;
  std::optional<ClockOffsetRecord> clock_offset;
  std::optional<HandEyeRecord> hand_eye;
  std::optional<ScaleMismatch> scale_mismatch;
  std::optional<ClockMismatch> clock_mismatch;
  std::vector<NeesRecord> nees;
  std::optional<OdometryRunRecord> odometry;
  /// Per pair, for plots; at most a few thousand (thinned evenly), empty for a failed run.
  std::vector<TimeNs> t;
  std::vector<Eigen::Vector3d> truth_m, estimate_m;
  /// Roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll), body to the truth's world, without jumps
  /// of a turn; of the estimate aligned. Empty where either has no orientations.
  std::vector<Eigen::Vector3d> truth_rpy_deg, estimate_rpy_deg;
  std::vector<double> error_m, error_deg;
};

inline std::string partName(const TrajectoryRun& r) {
  return r.sequence + "/" + r.calibration + "/" + r.run;
}

/// The run without errors, and why. What its positions say of scale and clocks stays: it may be why
/// it diverged.
inline TrajectoryRun failedRun(TrajectoryRun run, const std::string& problem) {
  run.status = RunStatus::kFailed;
  run.problem = problem;
  run.left_out.clear(), run.cure.clear();
  run.ate_translation_m = {}, run.ate_rotation_deg = {};
  run.rpe.clear(), run.nees.clear(), run.hand_eye.reset();
  run.association = {}, run.alignment = {};
  run.t.clear();
  run.truth_m.clear(), run.estimate_m.clear();
  run.truth_rpy_deg.clear(), run.estimate_rpy_deg.clear();
  run.error_m.clear(), run.error_deg.clear();
  return run;
}

void fields(auto& v, TrajectoryRun& r) {
  v.ifSet("sequence", r.sequence, "e.g. `MH_01`");
  v.ifSet("calibration", r.calibration, "what is compared, e.g. `kalibr`");
  v.ifSet("run", r.run, "repetition");
  v("status", r.status, "`complete`, `partial`, `failed`");
  v("problem", r.problem, "why partial or failed; empty if complete");
  v.derived("completed", r.status == RunStatus::kComplete, "1", "whether the status is `complete`");
  v.derived("failed", r.status == RunStatus::kFailed, "1", "whether it is `failed`");
  v("estimate", r.estimate, "file name");
  v("truth", r.truth, "file name");
  v.ifSet("without_truth", r.without_truth, "there is no ground truth: no errors");
  if (r.status != RunStatus::kFailed && !r.without_truth) {
    v("n", r.association.matches, "1", "pairs of poses");
    v("association", r.association.rule, "`one-to-one`, `interpolate`, `evo`, `rpg`, `ov_eval`");
    v("alignment", r.alignment.kind, "p_truth = scale R p_estimate + t: `se3`, `sim3`, `yaw`, ...");
    v("align_first", r.alignment.first_n, "pairs that it uses; 0: all");
    v("scale", r.alignment.scale, "1", "of the alignment");
    v("R", r.alignment.T_truth_estimate.R, "rows");
    v("t", r.alignment.T_truth_estimate.t, "m", "of the alignment");
    v.group("ate", [&](auto& g) {
      g("translation_m", r.ate_translation_m, "m", "absolute errors of the position");
      g("rotation_deg", r.ate_rotation_deg, "deg", "and of the orientation");
    });
    v("rpe", r.rpe, "errors of relative motion");
    v("coverage", r.coverage, "1", "share of the truth's span over which the estimate has poses");
    v("coverage_from_first_pose", r.coverage_from_first_pose, "1",
      "share of the span from the estimate's first pose on");
    v("starts_late_s", r.starts_late_s, "s", "first pose of the estimate - of the truth");
    v("stamps", r.association, "how stamps were paired");
  }
  v("clock_offset", r.clock_offset, "from correlating angular rates");
  v("hand_eye", r.hand_eye, "joins marker body and IMU");
  v("scale_mismatch", r.scale_mismatch, "where the positions agree far better by another scale");
  v("clock_mismatch", r.clock_mismatch, "where they do by another offset of the clocks");
  v.ifSet("nees", r.nees, "where the estimate has covariances");
  v("odometry", r.odometry, "how `plumbline odometry` made the estimate");
  v("remarks", r.remarks, "remarks for the reader, one sentence each");
  v("left_out", r.left_out, "why rotation and relative errors are not reported; empty: they are");
  v("cure", r.cure, "the option that makes them valid");
  v.array("t", r.t, "stamp of each pair (thinned to a few thousand)");
  v.array("truth_m", r.truth_m, "positions of the truth");
  v.array("estimate_m", r.estimate_m, "aligned positions of the estimate");
  v.array("truth_rpy_deg", r.truth_rpy_deg, "roll, pitch, yaw of the truth's body");
  v.array("estimate_rpy_deg", r.estimate_rpy_deg, "and of the aligned estimate's");
  v.array("error_m", r.error_m, "distance");
  v.array("error_deg", r.error_deg, "angle");
}

}  // namespace plumbline
