// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/fields/calibration_fields.h"
#include "report/records/calibration_record.h"
#include "report/records/study_statistics.h"

namespace plumbline {

/// Whether there is a calibration of a session.
enum class StudyStatus { kOk, kFailed };
constexpr std::array<const char*, 2> enumWords(StudyStatus /*of*/) { return {"ok", "failed"}; }

/// How long a participant took for one stage.
struct CaptureStage {
  std::string name;  ///< e.g. "camera", "camera_imu"
  double seconds = 0;
};

inline std::string partName(const CaptureStage& s) { return s.name; }

void fields(auto& v, CaptureStage& s) {
  v("name", s.name, "as STUDY.yaml names it");
  v("seconds", s.seconds, "s", "that the participant took");
}

void fields(auto& v, ParameterEstimate& p) {
  v("name", p.name, "as in a covariance");
  v("unit", p.unit, "`px`, `-`, `m`, `rad`, `s`");
  v("value", p.value, "rotations: component of Log(R)");
  v("std", p.std, "formal; rotations: of the left tangent");
  v("robust_std", p.robust_std, "cluster-robust, where it is known");
  v("robust_dof", p.robust_dof, "degrees of freedom of its square");
  v("resample_std", p.resample_std, "of the bootstrap, with `--resample`");
}

/// One session of a study: what was recorded, and what its calibration says. Figures of a
/// calibration that is not there are empty.
struct StudySession {
  std::string name, participant, method;
  int period = 0;
  std::optional<double> capture_s;
  bool finished = true;
  std::vector<CaptureStage> stages;
  StudyStatus status = StudyStatus::kOk;
  std::string failed_step, message;
  std::optional<VerdictLevel> verdict;  ///< none without a calibration
  std::string verdict_rule, verdict_sentence;
  std::optional<double> camera_rmse_px, camera_imu_rmse_px, held_out_rmse_px;
  std::optional<double> camera_entropy_nats, camera_imu_entropy_nats;
  std::optional<double> time_offset_s, time_offset_std_s;
  std::optional<Transform> T_SC0;
  std::optional<Vector6d> T_SC0_std;
  std::vector<ParameterEstimate> estimates;  ///< of both stages, see parameterEstimates()
  std::optional<TargetShape> board;
  std::optional<double> calibration_s, compliance;
  std::string page;
};

inline std::string partName(const StudySession& s) { return s.name; }

void fields(auto& v, StudySession& s) {
  v("name", s.name, "unique within the study");
  v("participant", s.participant, "the statistical unit");
  v("method", s.method, "one of `methods`");
  v("period", s.period, "1: the participant's first session");
  v("capture_s", s.capture_s, "s", "time until the participant was done or gave up");
  v("finished", s.finished, "1", "false: the participant gave up");
  v("stages", s.stages, "the same by stage");
  v("status", s.status, "`ok`: there is a calibration; `failed`");
  v.ifSet("failed_step", s.failed_step, "the step that failed");
  v.ifSet("message", s.message, "what it said");
  v("verdict", s.verdict, "`good`, `caution` or `bad`");
  v.ifSet("verdict_rule", s.verdict_rule, "rule of the gravest finding");
  v.ifSet("verdict_sentence", s.verdict_sentence, "its rule, evidence and advice");
  v("camera_rmse_px", s.camera_rmse_px, "px", "of the camera stage on its own recording");
  v("camera_imu_rmse_px", s.camera_imu_rmse_px, "px", "of the camera-IMU stage, likewise");
  v("held_out_rmse_px", s.held_out_rmse_px, "px", "root mean square over held-out recordings");
  v("camera_entropy_nats", s.camera_entropy_nats, "nat", "of the camera stage's parameters");
  v("camera_imu_entropy_nats", s.camera_imu_entropy_nats, "nat", "of the camera-IMU stage's");
  v("time_offset_s", s.time_offset_s, "s", "t_imu = t_cam + t_d, camera 0");
  v("time_offset_std_s", s.time_offset_std_s, "s", "its standard deviation");
  v("T_SC0", s.T_SC0, "m", "camera 0 in the IMU frame");
  v("T_SC0_std", s.T_SC0_std, "m, rad", "3 of the translation, 3 of the left tangent");
  v("estimates", s.estimates, "values and deviations of every parameter");
  v("board", s.board, "where the target's shape was fitted");
  v("calibration_s", s.calibration_s, "s", "that the program needed for the calibration");
  v("compliance", s.compliance, "1", "share of the guide's suggestions that were reached");
  v.ifSet("page", s.page, "the session's page, relative to the study's");
}

/// A calibration held fixed on a recording that no method saw.
struct StudyHeldOut {
  std::string session, recording;
  std::optional<double> rmse_px;
  std::string failure;
};

inline std::string partName(const StudyHeldOut& h) { return h.session + "/" + h.recording; }

void fields(auto& v, StudyHeldOut& h) {
  v("session", h.session, "whose calibration");
  v("recording", h.recording, "on which it was scored");
  v("rmse_px", h.rmse_px, "px", "sqrt(mean |e|^2); only poses are estimated");
  v.ifSet("failure", h.failure, "what the score lacks, or why there is none");
}

/// A calibration with a known offset added to the IMU's stamps.
struct StudyPerturbation {
  std::string session;
  double offset_ms = 0;
  std::optional<double> recovered_ms;
  std::string failure;
};

inline std::string partName(const StudyPerturbation& p) { return p.session; }

void fields(auto& v, StudyPerturbation& p) {
  v("session", p.session, "whose recording");
  v("offset_ms", p.offset_ms, "added to the IMU's stamps [ms]");
  v("recovered_ms", p.recovered_ms, "ms", "offset found minus the one found without perturbation");
  v.ifSet("failure", p.failure, "why nothing was found");
}

/// A trajectory estimated under a session's calibration.
struct StudyTrajectory {
  std::string session, sequence, run;
  std::optional<double> ate_m;
  std::string failure;
};

inline std::string partName(const StudyTrajectory& t) {
  return t.session + "/" + t.sequence + "/" + t.run;
}

void fields(auto& v, StudyTrajectory& t) {
  v("session", t.session, "whose calibration");
  v("sequence", t.sequence, "evaluation sequence");
  v.ifSet("run", t.run, "repetition");
  v("ate_m", t.ate_m, "m", "RMSE of the positions after alignment");
  v.ifSet("failure", t.failure, "why there is no figure");
}

/// How far a parameter of another tool is from ours.
struct StudyDifference {
  std::string parameter, unit;
  double difference = 0;
  std::optional<double> sigmas;
};

void fields(auto& v, StudyDifference& d) {
  v("parameter", d.parameter, "as in a covariance");
  v("unit", d.unit, "its unit");
  v("difference", d.difference, "the other tool's minus Plumbline's");
  v("sigmas", d.sigmas, "1",
    "difference in Plumbline's standard deviations, robust where known, by their degrees of "
    "freedom");
}

/// Another tool's result of a session.
struct StudyOther {
  std::string session, tool;
  std::optional<double> held_out_rmse_px;
  std::vector<StudyDifference> differences;
  std::string failure;
};

inline std::string partName(const StudyOther& o) { return o.session + "/" + o.tool; }

void fields(auto& v, StudyOther& o) {
  v("session", o.session, "of which session");
  v("tool", o.tool, "e.g. `kalibr`");
  v("held_out_rmse_px", o.held_out_rmse_px, "px", "as for Plumbline's calibrations");
  v("differences", o.differences, "from Plumbline's calibration of the same recording");
  v.ifSet("failure", o.failure, "why nothing could be compared");
}

/// A figure that changed against the nights before.
struct StudyAlarm {
  std::string metric, session;
  int night = 0;
  std::string kind;
  double was = 0, is = 0;
  std::string command;
};

inline std::string partName(const StudyAlarm& a) { return a.metric + " " + a.session; }

/// A cumulated drift has no value of a session: `is` is the median change over sessions since their
/// first nights, as a share of it; but failures and entropies may begin at 0, and have no share.
inline bool isDrift(const StudyAlarm& a) { return a.kind == "cusum"; }
inline bool hasShare(const StudyAlarm& a) {
  return isDrift(a) && a.metric != "failed" && !a.metric.ends_with("_nats");
}

void fields(auto& v, StudyAlarm& a) {
  v("metric", a.metric, "name of the figure");
  v.ifSet("session", a.session, "absent: of the study as a whole");
  v("night", a.night, "the first on which it was off");
  v("kind", a.kind, "`deterministic`: same inputs and version; `median`; `cusum`");
  v("was", a.was, "before; of `cusum` 0");
  v("is", a.is,
    "now; of `cusum` the median change over sessions, as a share of their first nights'");
  v.ifSet("command", a.command, "to run again");
}

/// A night of the history.
struct StudyNight {
  int night = 0;
  std::string date, version;
  int sessions = 0, failed = 0, alarms = 0;
  std::optional<double> seconds, held_out_rmse_px;
};

inline std::string partName(const StudyNight& n) { return "night " + std::to_string(n.night); }

void fields(auto& v, StudyNight& n) {
  v("night", n.night, "counts from 1");
  v("date", n.date, "ISO 8601, UTC");
  v("version", n.version, "of the program");
  v("sessions", n.sessions, "1", "in the study");
  v("failed", n.failed, "1", "of them");
  v("alarms", n.alarms, "1", "raised on it");
  v("seconds", n.seconds, "s", "wall time");
  v("held_out_rmse_px", n.held_out_rmse_px, "px", "median over sessions");
}

/// Everything that a study's page shows.
struct StudyRecord {
  std::string name;
  Provenance provenance;
  Verdict verdict;
  std::string rig;
  std::vector<std::string> methods;
  std::vector<std::string> endpoints;  ///< Holm's correction is over them
  double limit_s = 600;
  std::vector<StudySession> sessions;
  std::vector<StudyHeldOut> held_out;
  std::vector<StudyPerturbation> perturbations;
  std::vector<StudyTrajectory> trajectories;
  std::vector<StudyOther> others;
  std::vector<StudyAlarm> alarms;
  std::vector<StudyNight> nights;
  StudyStatistics statistics;  ///< addStatistics() computes it from the rest
};

/// summary.json.
void fields(auto& v, StudyRecord& r) {
  v.derived("schema", 1, "", "version of this format");
  v("name", r.name, "of the study");
  v.ifSet("rig", r.rig, "that all recordings are of");
  v("methods", r.methods, "the first is the baseline");
  v("endpoints", r.endpoints, "declared in STUDY.yaml");
  v("limit_s", r.limit_s, "s", "participants who gave up count as unfinished at this time");
  v("statistics", r.statistics, "statistics over the sessions");
  v("sessions", r.sessions, "one recording and its calibration each");
  v.ifSet("held_out", r.held_out, "scores on recordings that no method saw");
  v.ifSet("perturbations", r.perturbations, "offsets added to the IMU's stamps and recovered");
  v.ifSet("trajectories", r.trajectories, "odometry under each calibration");
  v.ifSet("others", r.others, "results of other tools");
  v.ifSet("alarms", r.alarms, "figures that changed against the nights before");
  v.ifSet("nights", r.nights, "history, oldest first");
  v("verdict", r.verdict, "what the night found");
  v("provenance", r.provenance, "where the result comes from");
}

}  // namespace plumbline
