// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/statistics.h"
#include "report/records/calibration_record.h"
#include "report/store/json_archive.h"

namespace plumbline {

// Fields of the structs that records of several kinds hold: one list per struct, for writing and
// reading; found by argument-dependent lookup.

template <class Archive>
void fields(Archive& a, Transform& T) {
  a("R", T.R);
  a("t", T.t);
}

template <class Archive>
void fields(Archive& a, Resolution& r) {
  a("width", r.width);
  a("height", r.height);
}

template <class Archive>
void fields(Archive& a, Intrinsics& i) {
  a("projection_model", i.projection_model);
  a("distortion_model", i.distortion_model);
  a("resolution", i.resolution);
  a("projection", i.projection);
  a("distortion", i.distortion);
}

template <class Archive>
void fields(Archive& a, CameraCalibration& c) {
  a("name", c.name);
  a("rostopic", c.rostopic);
  a("intrinsics", c.intrinsics);
  a("T_C0Ci", c.T_C0Ci);
  a("intrinsics_std", c.intrinsics_std);
  a("T_C0Ci_std", c.T_C0Ci_std);
}

template <class Archive>
void fields(Archive& a, ImuNoise& n) {
  a("gyro_density", n.gyro_density);
  a("gyro_random_walk", n.gyro_random_walk);
  a("accel_density", n.accel_density);
  a("accel_random_walk", n.accel_random_walk);
  a("rate_hz", n.rate_hz);
}

template <class Archive>
void fields(Archive& a, ImuCalibration& i) {
  a("T_SC0", i.T_SC0);
  a("time_offset_s", i.time_offset_s);
  a.added("camera_time_offsets_s", i.camera_time_offsets_s);
  a("gravity_m_s2", i.gravity_m_s2);
  a("noise", i.noise);
  a("rostopic", i.rostopic);
  a("T_SC0_std", i.T_SC0_std);
  a("time_offset_std_s", i.time_offset_std_s);
}

template <class Archive>
void fields(Archive& a, ErrorStatistics& s) {
  a("rmse_px", s.rmse_px);
  a("mean_px", s.mean_px);
  a("median_px", s.median_px);
  a("std_px", s.std_px);
  a("axis_mean_px", s.axis_mean_px);
  a("axis_std_px", s.axis_std_px);
  a("count", s.count);
}

template <class Archive>
void fields(Archive& a, Assumptions& s) {
  a("pixel_sigma_px", s.pixel_sigma_px);
  a("loss", s.loss);
  a("gravity_m_s2", s.gravity_m_s2);
  a("imu_noise", s.imu_noise);
}

template <class Archive>
void fields(Archive& a, ParameterCovariance& c) {
  a("names", c.names);
  a("units", c.units);
  a("matrix", c.matrix);
}

template <class Archive>
void fields(Archive& a, StageSeconds& s) {
  a("load", s.load);
  a("detect", s.detect);
  a("initialise", s.initialise);
  a("solve", s.solve);
  a("covariance", s.covariance);
  a("total", s.total);
}

template <class Archive>
void fields(Archive& a, StageSummary& s) {
  a("reprojection", s.reprojection);
  a("per_camera", s.per_camera);
  a("corners_used", s.corners_used);
  a("corners_offered", s.corners_offered);
  a("views_used", s.views_used);
  a("views_offered", s.views_offered);
  a("converged", s.converged);
  a("iterations", s.iterations);
  a("cost", s.cost);
  a("covariance", s.covariance);
  a("entropy_nats", s.entropy_nats);
  a("seconds", s.seconds);
}

template <class Archive>
void fields(Archive& a, AprilGrid& g) {
  a("rows", g.rows);
  a("cols", g.cols);
  a("tag_size", g.tag_size);
  a("spacing", g.spacing);
}

template <class Archive>
void fields(Archive& a, CalibrationScore& s) {
  a("label", s.label);
  a("session", s.session);
  a("part", s.part);
  a("held_out", s.held_out);
  a("reprojection", s.reprojection);
  a("per_camera", s.per_camera);
  a("cameras", s.cameras);
  a("views_used", s.views_used);
  a("views_offered", s.views_offered);
  a("camera_imu", s.camera_imu);
  a("camera_imu_cost", s.camera_imu_cost);
  a("gyro_rms_rad_s", s.gyro_rms_rad_s);
  a("accel_rms_m_s2", s.accel_rms_m_s2);
  a("entropy_nats", s.entropy_nats);
  a("entropy_parameters", s.entropy_parameters);
  a("problem", s.problem);
  a.added("camera_imu_entropy_nats", s.camera_imu_entropy_nats);
  a.added("camera_imu_entropy_parameters", s.camera_imu_entropy_parameters);
}

}  // namespace plumbline
