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
#include "report/records/calibration_record.h"

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

/// The run without errors, and why.
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

/// A calibration over all runs of one sequence, or of all ("").
struct RunsSummary {
  std::string sequence, calibration;
  std::size_t expected = 0, complete = 0, partial = 0, failed = 0;
  double completion = 0;
  std::optional<double> ate_median_m;
  VerdictLevel level = VerdictLevel::kGood;
};

inline std::string partName(const RunsSummary& s) { return s.sequence + "/" + s.calibration; }

void fields(auto& v, RunsSummary& s) {
  v.ifSet("sequence", s.sequence, "absent: over all sequences");
  v("calibration", s.calibration, "whose runs");
  v("expected", s.expected, "1", "runs");
  v("complete", s.complete, "1", "of them");
  v("partial", s.partial, "1", "of them");
  v("failed", s.failed, "1", "of them");
  v("completion", s.completion, "1", "complete / expected");
  v("ate_median_m", s.ate_median_m, "m",
    "median ATE over the expected runs, a run that is not complete counts as infinite; absent "
    "where the median is infinite");
  v("level", s.level, "`bad` where a run failed, `caution` where one is partial");
}

/// Two calibrations over the same sequences and runs: d = ATE under b - ATE under a, where ATE is
/// the RMSE of the positions [m]. Negative: b is better.
struct PairedDifference {
  std::string a, b;
  std::size_t pairs = 0, left_out = 0;
  double mean_m = 0, median_m = 0, std_m = 0;
  std::size_t b_better = 0, ties = 0;
  double sign_test_p = 1;
  /// The least n of five and more with (t_{0.975, n-1} + t_{0.8, n-1}) s / sqrt(n) <= |mean|, s the
  /// spread of the sequences' means. Empty below three sequences.
  std::optional<double> pairs_needed;
  std::optional<double> low_m, high_m;  ///< of `mean_interval_m`
  std::string better;
};

inline std::string partName(const PairedDifference& d) { return d.b + " - " + d.a; }

template <class V>
void fields(V& v, PairedDifference& d) {
  v("a", d.a, "first calibration");
  v("b", d.b, "second: d = ATE under b - ATE under a; negative: b is better");
  v("pairs", d.pairs, "1", "complete under both; without any, the figures below are absent");
  v("left_out", d.left_out, "1", "(sequence, run) under either that is not complete under both");
  if (d.pairs == 0 && !V::kAll) return;
  v("mean_m", d.mean_m, "m", "of the sequences' means of d");
  v("median_m", d.median_m, "m", "of d");
  v("std_m", d.std_m, "m", "of d, divisor n");
  v("b_better", d.b_better, "1", "pairs with d < 0");
  v("ties", d.ties, "1", "pairs with d = 0");
  v("sign_test_p", d.sign_test_p, "1",
    "two-sided, exact (binomial), of the signs of the sequences' means of d; means of 0 are left "
    "out");
  v("pairs_needed", d.pairs_needed, "1",
    "sequences, a pair each, that would show such a mean at 95 % in 4 of 5 studies, by the spread "
    "of their means; at least 5");
  std::optional<std::array<double, 2>> interval;
  if (d.low_m && d.high_m) interval = {*d.low_m, *d.high_m};
  v("mean_interval_m", interval, "m",
    "95 % interval of the mean: Student's t over sequences; absent below 5");
  if constexpr (V::kReads) {
    d.low_m.reset();
    d.high_m.reset();
    if (interval) d.low_m = (*interval)[0], d.high_m = (*interval)[1];
  }
  v.ifSet("better", d.better, "which has the lower errors; absent where the interval contains 0");
}

/// What moving one parameter of a calibration does to the ATE (RMSE of positions) of a sequence.
struct ParameterSensitivity {
  std::string name, unit;
  double step = 0;
  std::optional<double> plus_m, minus_m, change_m;
  bool above_chance = false;
};

void fields(auto& v, ParameterSensitivity& p) {
  v("name", p.name, "e.g. `T_SC0.ty`");
  v("unit", p.unit, "`px`, `-`, `m`, `rad`, `s`");
  v("step", p.step, "change of the parameter, in `unit`");
  v("plus_m", p.plus_m, "m", "change of the ATE with + step; absent where the run failed");
  v("minus_m", p.minus_m, "m", "with - step; absent for the difference of two calibrations");
  v("change_m", p.change_m, "m", "mean of both; absent where a run failed");
  v.ifSet("above_chance", p.above_chance, "the change is more than twice `noise_m`");
}

inline std::string partName(const ParameterSensitivity& p) { return p.name; }

/// Every parameter of a calibration moved by itself.
struct CalibrationSensitivity {
  std::string sequence, calibration, towards;
  double ate_m = 0;
  std::optional<double> noise_m;  ///< empty where fewer than two of its runs have an ATE
  std::optional<double> whole_m, sum_m, interaction_m;
  std::vector<ParameterSensitivity> parameters;
};

inline std::string partName(const CalibrationSensitivity& s) {
  return s.sequence + "/" + s.calibration + (s.towards.empty() ? "" : "/" + s.towards);
}

void fields(auto& v, CalibrationSensitivity& s) {
  v("sequence", s.sequence, "on which it was run");
  v("calibration", s.calibration, "whose parameters are changed");
  v.ifSet("towards", s.towards, "whose values they take; absent: steps are standard deviations");
  v("ate_m", s.ate_m, "m", "unmoved");
  v("noise_m", s.noise_m, "m", "standard deviation of the ATE under changes of 1e-3 steps");
  v("whole_m", s.whole_m, "m", "ATE under `towards` - `ate_m`");
  v("sum_m", s.sum_m, "m", "of all changes; absent where one is missing");
  v("interaction_m", s.interaction_m, "m", "whole - sum: what single changes do not explain");
  v("parameters", s.parameters, "each changed by itself, the largest effect first");
}

/// Runs, and what they say together.
struct TrajectoryStudy {
  std::vector<TrajectoryRun> runs;
  std::vector<RunsSummary> summary;
  std::vector<PairedDifference> paired;
  std::vector<CalibrationSensitivity> sensitivity;
};

/// Each calibration over everything: over all sequences, or the only one.
inline std::vector<RunsSummary> overAll(const TrajectoryStudy& study) {
  std::vector<RunsSummary> all;
  for (const RunsSummary& s : study.summary) {
    if (s.sequence.empty()) all.push_back(s);
  }
  return all.empty() ? study.summary : all;
}

void fields(auto& v, TrajectoryStudy& s) {
  v("summary", s.summary, "completion and error by sequence, then over all");
  v("paired", s.paired, "every two calibrations over the same sequences and runs");
  v.ifSet("sensitivity", s.sensitivity, "effect of each parameter on the ATE");
  v("runs", s.runs, "each estimate against its truth");
}

/// What the verdict of trajectories is called where nothing is amiss: an error has no level, for
/// what it may be depends on the use.
constexpr const char* kCompleteWord = "complete";

/// What `evaluate trajectory` found, for one run or many.
struct TrajectoryRecord : TrajectoryStudy {
  std::string name;
  Provenance provenance;
  Verdict verdict;
};

/// trajectory.json.
void fields(auto& v, TrajectoryRecord& r) {
  v.derived("schema", 1, "", "version of this format");
  v("name", r.name, "of the study");
  fields(v, static_cast<TrajectoryStudy&>(r));
  v("verdict", r.verdict, "how far the figures can be trusted");
  v("provenance", r.provenance, "where the result comes from");
}

/// One estimate judged by itself.
struct SingleTrajectory {
  TrajectoryRun run;
  Verdict verdict;
  Provenance provenance;
};

/// `evaluate trajectory --json`: the run's fields at the top.
void fields(auto& v, SingleTrajectory& s) {
  fields(v, s.run);
  v("verdict", s.verdict, "how far the figures may be trusted");
  v("provenance", s.provenance, "where the result comes from");
}

}  // namespace plumbline
