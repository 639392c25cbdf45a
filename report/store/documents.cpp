// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/documents.h"

#include "report/store/shared_fields.h"

namespace plumbline {

// Fields of what only a calibration record holds; see shared_fields.h.

template <class Archive>
void fields(Archive& a, ImuNoiseCheck& c) {
  a("expected_rms", c.expected_rms);
  a("factor", c.factor);
  a("redundancy", c.redundancy);
}

template <class Archive>
void fields(Archive& a, ImuNoiseChecks& c) {
  a("gyro", c.gyro);
  a("accel", c.accel);
  a("gyro_bias", c.gyro_bias);
  a("accel_bias", c.accel_bias);
  a("pose_pixel_sigma", c.pose_pixel_sigma);
}

template <class Archive>
void fields(Archive& a, ImuResidualSummary& s) {
  a("gyro_rms_rad_s", s.gyro_rms_rad_s);
  a("accel_rms_m_s2", s.accel_rms_m_s2);
  a("gyro_normalised_rms", s.gyro_normalised_rms);
  a("accel_normalised_rms", s.accel_normalised_rms);
  a("gyro_bias_normalised_rms", s.gyro_bias_normalised_rms);
  a("accel_bias_normalised_rms", s.accel_bias_normalised_rms);
  a("chi2", s.chi2);
  a("dof", s.dof);
  a.added("noise", s.noise);
}

template <class Archive>
void fields(Archive& a, CameraStageResult& s) {
  a("cameras", s.cameras);
  a("summary", s.summary);
}

template <class Archive>
void fields(Archive& a, InertialCheck& s) {
  a("target_scale", s.target_scale);
  a("target_scale_std", s.target_scale_std);
  a("gravity_m_s2", s.gravity_m_s2);
}

template <class Archive>
void fields(Archive& a, CameraImuStageResult& s) {
  a("imu", s.imu);
  a("cameras", s.cameras);
  a("gravity_F", s.gravity_F);
  a.added("frames_without_imu", s.frames_without_imu);
  a.added("frames_without_pose", s.frames_without_pose);
  a.added("imu_gaps", s.imu_gaps);
  a.added("imu_rate_hz", s.imu_rate_hz);
  a.added("inertial_check", s.inertial_check);
  a("imu_summary", s.imu_summary);
  a("summary", s.summary);
}

template <class Archive>
void fields(Archive& a, CameraCounts& c) {
  a("views_offered", c.views_offered);
  a("views_with_corners", c.views_with_corners);
  a("corners", c.corners);
  a("tags", c.tags);
}

template <class Archive>
void fields(Archive& a, ResampleSpread& s) {
  a("resamples", s.resamples);
  a("failed", s.failed);
  a("names", s.names);
  a("std", s.std);
}

template <class Archive>
void fields(Archive& a, HeldCalibration& h) {
  a("file", h.file);
  a("scores", h.scores);
}

/// What stands in the document "head".
template <class Archive>
void fields(Archive& a, CalibrationRecord& r) {
  a("assumptions", r.assumptions);
  a("target", r.target);
  a("counts", r.counts);
  a("camera_resample", r.camera_resample);
  a("camera_imu_resample", r.camera_imu_resample);
  a.added("held", r.held);
}

namespace store_internal {

std::string headDocument(const CalibrationRecord& record) {
  return JsonWriter::toJson(record).dump();
}

void readHeadDocument(const std::string& json, CalibrationRecord& record) {
  JsonReader::fromJson(Json::parse(json), record);
}

std::string cameraDocument(const CameraStageResult& stage) {
  return JsonWriter::toJson(stage).dump();
}

CameraStageResult readCameraDocument(const std::string& json) {
  return parseAs<CameraStageResult>(json);
}

std::string cameraImuDocument(const CameraImuStageResult& stage) {
  return JsonWriter::toJson(stage).dump();
}

CameraImuStageResult readCameraImuDocument(const std::string& json) {
  return parseAs<CameraImuStageResult>(json);
}

}  // namespace store_internal
}  // namespace plumbline
