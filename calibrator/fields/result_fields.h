// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/fields/calibration_fields.h"

namespace plumbline {

// Field lists (see fields.h) of the stages' results.

/// Standard deviation of each camera's offset [s]: of its own parameter, named by the camera
/// ("time_offset.cam1"), else
/// of the shared one; empty where the covariance has none.
inline std::vector<std::optional<double>> timeOffsetDeviations(
    const ParameterCovariance& covariance, const std::vector<CameraCalibration>& cameras) {
  const auto deviation = [&](const std::string& name) -> std::optional<double> {
    const auto found = std::ranges::find(covariance.names, name);
    if (found == covariance.names.end()) return std::nullopt;
    const auto i = found - covariance.names.begin();
    return std::sqrt(covariance.matrix(i, i));
  };
  std::vector<std::optional<double>> deviations;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const auto own = deviation("time_offset." + parameterOwner(cameras, c));
    deviations.push_back(own ? own : deviation("time_offset"));
  }
  return deviations;
}

void fields(auto& v, CornerResidual& r) {
  v("camera", r.camera, "its position");
  v("frame", r.frame, "index into the stage's frames");
  v("corner_id", r.corner_id, "4 tag + corner");
  v("uv", r.uv, "px", "measured");
  v("error", r.error, "px", "measured - projected");
  v("used", r.used, "false: rejected as an outlier");
}

void fields(auto& v, StageSeconds& s) {
  v("load", s.load, "s", "reading the session");
  v("detect", s.detect, "s", "detection of corners");
  v("initialise", s.initialise, "s", "start values");
  v("solve", s.solve, "s", "optimisation");
  v("checks", s.checks, "s",
    "cameras: choice of lens models and of the board's shape; camera-IMU: tests for faults and "
    "noise");
  v("covariance", s.covariance, "s", "covariance at the solution");
  v("total", s.total, "s", "of the stage, without loading and detection");
}

void fields(auto& v, HalvesBlock& b) {
  v("name", b.name, "the block of parameters");
  v("chi2", b.chi2, "1", "of the halves' difference, with their cluster-robust covariance");
  v("parameters", b.parameters, "1", "in the block");
  v("limit", b.limit, "1", "99 % bound of `chi2`");
  v("worst", b.worst, "parameter with the largest difference in standard deviations");
  v("difference", b.difference, "of it, second half minus first, in `unit`");
  v("std", b.std, "standard deviation of that difference, in `unit`");
  v("unit", b.unit, "of `difference` and `std`");
}

void fields(auto& v, HalvesCheck& h) {
  v("split_ns", h.split, "stamp of the second half's first frame");
  v("blocks", h.blocks, "of the stage's parameters");
}

/// All but the covariance, which calibration.json has apart, and the seconds, which only a stage
/// has.
void figures(auto& v, StageSummary& s) {
  fields(v, s.reprojection);
  v("per_camera", s.per_camera, "the same over each camera's used corners");
  v("corners_used", s.corners_used, "1", "in the solution");
  v("corners_offered", s.corners_offered, "1", "in the session");
  v("views_used", s.views_used, "1", "(camera, frame) pairs with used corners");
  v("views_offered", s.views_offered, "1", "all views of the session, with or without corners");
  v("robust_std", s.robust_std, "cluster-robust standard deviations, in the order of `covariance`");
  v("robust_dof", s.robust_dof, "degrees of freedom of their squares (Satterthwaite)");
  v.derived("half_width_90", halfWidths90(s.robust_std, s.robust_dof), "",
            "half widths of 90 % intervals: `robust_std` times quantile 0.95 of Student's t with "
            "`robust_dof`");
  v("halves", s.halves, "whether the recording's halves, each solved separately, agree");
  v("entropy_nats", s.entropy_nats, "nat",
    "0.5 log((2 pi e)^n |Sigma|), Sigma the stage's `covariance`; compare only under the same "
    "parameter list, units and noise");
  v("converged", s.converged, "1", "whether the solver ended at a minimum");
  v("iterations", s.iterations, "1", "steps of the solver");
  v("cost", s.cost, "1", "0.5 x sum of squared residuals over their sigma, after the loss");
}

void fields(auto& v, StageSummary& s) {
  figures(v, s);
  v("covariance", s.covariance, "of the calibration parameters");
}

constexpr std::array<const char*, 7> enumWords(TargetFinding /*of*/) {
  return {"not tested", "not determined", "lens model misfits", "as stated",
          "bent",       "known",          "another board"};
}

void fields(auto& v, TargetFit& t) {
  v("finding", t.finding, "test of the board's shape on the recording");
  v("shape", t.shape, "terms estimated with the cameras, formal covariance");
  v.group("std", [&](auto& g) { targetTermFields(g, t.std); });
  v("blocks", t.blocks, "1", "of time, over which `std` is cluster-robust; 0: formal");
  v("held_out_px", t.held_out_px, "px",
    "RMS, after the loss, of frames that cameras and board were not fitted to");
  v("flat_held_out_px", t.flat_held_out_px, "px", "the same with the board as stated or given");
  v("gain_px2", t.gain_px2, "px^2",
    "mean over blocks of time: by how much the squares are smaller");
  v("gain_std_px2", t.gain_std_px2, "px^2", "standard deviation of that mean");
  v("higher_held_out_px", t.higher_held_out_px, "px",
    "`held_out_px` with terms of degrees 3 and 4 besides; absent: not tried");
  v("higher_gain_px2", t.higher_gain_px2, "px^2",
    "by how much the squares are smaller with them than with the twelve terms");
  v("higher_gain_std_px2", t.higher_gain_std_px2, "px^2", "standard deviation of that mean");
  v("corners_held_out_px", t.corners_held_out_px, "px",
    "`held_out_px` with remainders of single corners besides; absent: not tried");
  v("corners_gain_px2", t.corners_gain_px2, "px^2",
    "by how much the squares are smaller with them than with degrees 3 and 4");
  v("corners_gain_std_px2", t.corners_gain_std_px2, "px^2", "standard deviation of that mean");
  v("corners_plane_std", t.corners_plane_std, "m",
    "standard deviation of their prior along x and y, estimated; absent: none are kept");
  v("corners_height_std", t.corners_height_std, "m", "the same in height");
}

void fields(auto& v, ModelCandidate& m) {
  v("camera_model", m.projection, "the projection");
  v("distortion_model", m.distortion, "its distortion");
  v("parameters", m.parameters, "1", "of the lens");
  v("frames", m.frames, "1",
    "frames of the comparison: fewer where they were enough to reject the model");
  v("held_out_px", m.held_out_px, "px",
    "RMS, after the loss, of frames that it was not fitted to; null: none");
  v("excess_px2", m.excess_px2, "px^2",
    "mean over blocks of time: by how much its squares exceed the best model's");
  v("excess_std_px2", m.excess_std_px2, "px^2", "standard deviation of that mean");
}

constexpr std::array<const char*, 5> enumWords(ModelReason /*of*/) {
  return {"not tested", "stated", "smallest", "tangential", "common"};
}

void fields(auto& v, ModelChoice& m) {
  v("camera", m.camera, "its name");
  v("camera_model", m.projection, "the chosen projection");
  v("distortion_model", m.distortion, "its distortion");
  v("reason", m.reason,
    "why: within one standard error of the best, `stated` (with tangential terms: two), "
    "`tangential` (the smallest with such terms) or `smallest`; `common` to all cameras at less "
    "than 1 % of the squares; or `not tested`");
  v("candidates", m.candidates, "models that were tried, the best first");
}

void fields(auto& v, BiasRatio& b) {
  v("camera", b.camera, "its name");
  v("bias_ratio", b.ratio, "1", "share of the mean squared error that is systematic");
  v("noise_px", b.noise_px, "px", "of a corner per axis, from patches of neighbouring corners");
  v("error_px", b.error_px, "px", "the same of all residuals");
  v("patches", b.patches, "1", "number of patches behind `noise_px`; 0: too few");
}

void fields(auto& v, Decentring& d) {
  v("camera", d.camera, "its name");
  v("p", d.p, "1", "p1 and p2 of tangential terms beside the model, of a pinhole's scale");
  v("std", d.std, "1", "cluster-robust standard deviations");
  v("f", d.f, "1", "Fisher's F of `p` against zero");
  v("limit", d.limit, "1", "`f` that one centred lens in ten thousand exceeds by chance");
  v("turn", d.turn, "rad", "of the target in the camera's frame if they were modelled, mean");
}

void fields(auto& v, CameraStageResult& s) {
  figures(v, s.summary);
  v("seconds", s.summary.seconds, "wall clock");
  v("cameras", s.cameras, "as this stage estimated them");
  v("target", s.target, "board of the solution");
  v("target_fit", s.target_fit, "the board's shape as estimated, whether or not it was kept");
  v.ifSet("model_choice", s.models, "lens models tried for each camera, and the one chosen");
  v.ifSet("bias", s.bias, "systematic error that lens model and board do not explain, per camera");
  v.ifSet("decentring", s.decentring,
          "whether lenses whose models have no tangential terms ask for them, per camera");
  v.array("frames", s.frames, "frames of the solution");
  v.array("T_FC0", s.T_FC0, "camera 0 in the target's frame, one per frame");
  v.array("residuals", s.residuals, "corners' reprojection errors");
}

void fields(auto& v, ImuState& s) {
  v("T_FS", s.T_FS, "m", "the IMU in the target's frame");
  v("v_F", s.v_F, "m/s", "its velocity there");
  v("gyro_bias", s.gyro_bias, "rad/s", "bias of the gyroscope");
  v("accel_bias", s.accel_bias, "m/s^2", "bias of the accelerometer");
}

void fields(auto& v, MeanReading& r) {
  v("measured", r.measured, "mean over the interval, in the IMU's axes at its start");
  v("predicted", r.predicted, "the same from the states at its ends");
  v("std", r.std, "of `measured`, by the assumed density");
}

void fields(auto& v, ImuIntervalResidual& r) {
  v("t_ns", r.t, "of the earlier frame, camera clock");
  v("dt_s", r.dt_s, "s", "length of the interval");
  v("rotation_rad", r.rotation_rad, "rad", "residual of the rotation");
  v("velocity_m_s", r.velocity_m_s, "m/s", "of the velocity");
  v("position_m", r.position_m, "m", "of the position");
  v("normalised", r.normalised, "1", "rotation, velocity, position, bias walks over their noise");
  v("gyro", r.gyro, "rad/s", "readings of the gyroscope: measured and predicted");
  v("accel", r.accel, "m/s^2", "readings of the accelerometer: measured and predicted");
}

void fields(auto& v, ImuNoiseCheck& c) {
  v("expected_rms", c.expected_rms, "1",
    "expected normalised RMS; below 1, since states absorb part of the residual");
  v("factor", c.factor, "1", "factor by which the density should be multiplied");
  v("redundancy", c.redundancy, "1", "redundancy: effective number of residuals");
}

void fields(auto& v, ImuNoiseChecks& c) {
  v("gyro", c.gyro, "gyroscope, from the rotation rows");
  v("accel", c.accel, "accelerometer, from the velocity and position rows");
  v("gyro_bias", c.gyro_bias, "random walk of the gyroscope's bias");
  v("accel_bias", c.accel_bias, "random walk of the accelerometer's bias");
  v("pose_pixel_sigma", c.pose_pixel_sigma, "px",
    "standard deviation of a corner, per axis, that explains the noise of the poses; 0 where they "
    "do not tell it");
}

void fields(auto& v, ImuResidualSummary& s) {
  v("gyro_rms_rad_s", s.gyro_rms_rad_s, "rad/s", "RMS of |rotation residual| / interval");
  v("accel_rms_m_s2", s.accel_rms_m_s2, "m/s^2", "RMS of |velocity residual| / interval");
  v.group("imu_normalised_rms", [&](auto& g) {
    g("gyro", s.gyro_normalised_rms, "1",
      "RMS per component over the assumed noise, rotation rows; expect `imu_noise`'s");
    g("accel", s.accel_normalised_rms, "1", "velocity and position rows");
    g("gyro_bias", s.gyro_bias_normalised_rms, "1", "random walk of the gyroscope's bias");
    g("accel_bias", s.accel_bias_normalised_rms, "1", "random walk of the accelerometer's bias");
  });
  v("imu_noise", s.noise, "noise densities estimated from the residuals");
  v("imu_chi2", s.chi2, "1", "sum of squared normalised residuals");
  v("imu_dof", s.dof, "1", "their number");
}

void fields(auto& v, FrameErrors& e) {
  v("rmse_px", e.rmse_px, "px", "at the solution");
  v("free_rmse_px", e.free_rmse_px, "px", "with every frame at the pose of its own corners");
  v("along", e.along, "px^2", "squared error of a frame that a shift of its stamp explains, mean");
  v("across", e.across, "px^2",
    "squared error that each of the other five directions explains, mean");
  v("neighbours", e.neighbours, "1", "correlation of the shifts of consecutive frames");
  v("jitter_s", e.jitter_s, "s", "RMS of the shifts beyond what directions explain by chance");
}

void fields(auto& v, InertialCheck& c) {
  v("target_scale", c.target_scale, "1", "metres per stated metre of the target");
  v("target_scale_std", c.target_scale_std, "1", "its standard deviation");
  v("gravity_m_s2", c.gravity_m_s2, "m/s^2", "magnitude as measured; 0: not known");
  v.ifSet("residual_ratio", c.residual_ratio,
          "residual of the fit over the residual that noise explains");
}

void fields(auto& v, ImuSpike& s) {
  v("t_ns", s.t, "stamp of the sample, as recorded");
  v("channel", s.channel, "0 to 2: gyroscope x, y, z; 3 to 5: accelerometer");
  v("size", s.size, "reading minus the prediction from its neighbours, SI units");
  v("line", s.line, "of the file; 0: not known");
}

void fields(auto& v, ImuPause& p) {
  v("t_ns", p.t, "stamp of the sample before it, as recorded");
  v("duration_s", p.duration_s, "s", "to the next sample");
  v("line", p.line, "of the sample before it in the file; 0: not known");
}

void fields(auto& v, RepeatedView& r) {
  v("camera", r.camera, "its position");
  v("t_ns", r.t, "stamp of the view");
}

void fields(auto& v, MisplacedTag& m) {
  v("camera", m.camera, "its position");
  v("t_ns", m.t, "stamp of the view");
  v("tag", m.tag, "id that was read");
  v("place", m.place, "tag at whose position it is");
}

void fields(auto& v, Screening& s) {
  v.ifSet("spikes", s.spikes, "samples of the IMU that their neighbours contradict: excluded");
  v.ifSet("pauses", s.pauses, "gaps in the IMU's samples: frames are not linked across them");
  v.ifSet("repeated_views", s.repeated_views,
          "views that repeat the corners before them though the rig moved: excluded");
  v.ifSet("misplaced_tags", s.misplaced_tags, "tags that are not at the position of their id");
  v.ifSet("false_corners", s.false_corners,
          "corners far from where the rest of their view puts them: excluded under a robust loss");
  v.ifSet("grazing_corners", s.grazing_corners,
          "excluded: seen at 89 degrees and more from the optical axis");
}

void fields(auto& v, FaultTest& t) {
  v("fault", t.fault, "what was tested");
  v("camera", t.camera, "its position; -1: no camera's own fault");
  v("since_ns", t.since, "time from which it applies, camera clock");
  v("estimate", t.estimate, "size to first order, SI units (calibrator/base/results.h)");
  v("std", t.std,
    "its cluster-robust standard deviation; null: the motion does not determine that component");
  v("frequency_hz", t.frequency_hz, "of the swinging motion");
  v("chi2", t.chi2, "of the estimate against zero");
  v("explained", t.explained,
    "decrease of twice the batch's cost when the fault is modelled, over its overdispersion");
  v("dof", t.dof, "number of its parameters that were tested");
  v("significance", t.significance, "chi2 as a deviate of the normal distribution");
  v("shift", t.shift, "change of T_SC0 (3 m, 3 rad) and the offset [s] if it were modelled");
  v("shift_sigma", t.shift_sigma, "the largest of these in robust standard deviations");
}

void fields(auto& v, FaultDiagnosis& d) {
  v("causes", d.causes,
    "significant faults, most important first, each tested with those before it modelled");
  v("alternative", d.alternative, "explains the residuals as well as the first cause");
  v("tests", d.tests, "every fault alone");
  v("robust_std", d.robust_std, "cluster-robust, of T_SC0 (3 m, 3 rad) and the offset [s]");
  v("formal_std", d.formal_std, "formal ones");
  v("robust_dof", d.robust_dof, "degrees of freedom of the squares of `robust_std`");
  v.derived("half_width_90", halfWidths90(Eigen::VectorXd(d.robust_std), d.robust_dof), "",
            "half widths of 90 % intervals: this stage's alone; see the stage's `half_width_90`");
}

/// Of the stage alone: `imu` and `cameras` stand at the top of calibration.json.
void fields(auto& v, CameraImuStageResult& s) {
  figures(v, s.summary);
  v("seconds", s.summary.seconds, "wall clock");
  v.derived("time_offset_s", s.imu.timeOffset(), "s", "as in `imu`");
  v.derived("time_offset_std_s", s.imu.time_offset_std_s, "s", "as in `imu`");
  std::optional<std::vector<std::optional<double>>> offsets, deviations;
  if (haveOwnOffsets(s.imu.time_offsets)) {
    offsets = ownOffsets(s.imu.time_offsets);
    deviations = timeOffsetDeviations(s.summary.covariance, s.cameras);
  }
  v.derived("camera_time_offsets_s", offsets, "s", "as in `imu`");
  v.derived("camera_time_offsets_std_s", deviations, "s", "camera by camera");
  fields(v, s.imu_summary);
  v.derived("frames_used", s.frames.size(), "1", "frames in the solution");
  v("frames_without_imu", s.frames_without_imu, "1",
    "not used: not covered by IMU samples, or isolated between gaps");
  v("frames_without_pose", s.frames_without_pose, "1",
    "not used: no pose from the frame's own corners");
  v("imu_gaps", s.imu_gaps, "1", "gaps of the IMU across which frames are not linked");
  v("imu_rate_hz", s.imu_rate_hz, "Hz", "inverse of the median interval between IMU samples");
  v("inertial_check", s.inertial_check, "linear fit before the batch");
  v("frame_errors", s.frame_errors, "poses compared with those from each frame's corners alone");
  v.ifSet("screening", s.screening, "measurements that contradict their neighbours or the target");
  v("faults", s.faults, "score tests of faults that the batch does not model");
  v("gravity_F_m_s2", s.gravity_F, "m/s^2", "gravity in the target's frame, pointing down");
  v.array("frames", s.frames, "frames of the solution");
  v.array("states", s.states, "one per frame");
  v.array("residuals", s.residuals, "corners' reprojection errors");
  v.array("intervals", s.imu_residuals, "residuals of the IMU between consecutive frames");
}

}  // namespace plumbline
