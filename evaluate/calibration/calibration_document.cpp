// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/calibration_document.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/results/json_values.h"
#include "evaluate/results/record_json.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

Json secondsOf(const StageSeconds& s) {
  return {{"load", s.load},   {"detect", s.detect},         {"initialise", s.initialise},
          {"solve", s.solve}, {"covariance", s.covariance}, {"total", s.total}};
}

Json stageOf(const StageSummary& s) {
  Json json = errorsJson(s.reprojection);
  json.update(Json{{"corners_used", s.corners_used},
                   {"corners_offered", s.corners_offered},
                   {"views_used", s.views_used},
                   {"views_offered", s.views_offered},
                   {"entropy_nats", s.entropy_nats},
                   {"converged", s.converged},
                   {"iterations", s.iterations},
                   {"cost", s.cost},
                   {"seconds", secondsOf(s.seconds)}});
  return json;
}

Json checkOf(const ImuNoiseCheck& check) {
  return {{"expected_rms", check.expected_rms},
          {"factor", check.factor},
          {"redundancy", check.redundancy}};
}

// What the residuals say of the densities that were assumed.
Json noiseChecksOf(const ImuNoiseChecks& noise) {
  return {{"gyro", checkOf(noise.gyro)},
          {"accel", checkOf(noise.accel)},
          {"gyro_bias", checkOf(noise.gyro_bias)},
          {"accel_bias", checkOf(noise.accel_bias)},
          {"pose_pixel_sigma", noise.pose_pixel_sigma}};
}

// Of each camera's own time offset; null where the covariance has none.
Json offsetDeviations(const CameraImuStageResult& stage) {
  const std::vector<std::string>& names = stage.summary.covariance.names;
  const Eigen::VectorXd std = stage.summary.covariance.standardDeviations();
  Json json = Json::array();
  for (std::size_t c = 0; c < stage.imu.camera_time_offsets_s.size(); ++c) {
    const auto own = std::find(names.begin(), names.end(), fmt::format("time_offset.cam{}", c));
    const auto shared = std::find(names.begin(), names.end(), "time_offset");
    const auto found = own != names.end() ? own : shared;
    json.push_back(found != names.end() ? Json(std[found - names.begin()]) : Json());
  }
  return json;
}

Json cameraImuOf(const CameraImuStageResult& stage) {
  Json json = stageOf(stage.summary);
  const ImuResidualSummary& imu = stage.imu_summary;
  json["time_offset_s"] = stage.imu.time_offset_s;
  if (stage.imu.time_offset_std_s) json["time_offset_std_s"] = *stage.imu.time_offset_std_s;
  if (!stage.imu.camera_time_offsets_s.empty()) {
    json["camera_time_offsets_s"] = stage.imu.camera_time_offsets_s;
    json["camera_time_offsets_std_s"] = offsetDeviations(stage);
  }
  json["gyro_rms_rad_s"] = imu.gyro_rms_rad_s;
  json["accel_rms_m_s2"] = imu.accel_rms_m_s2;
  json["imu_normalised_rms"] = {{"gyro", imu.gyro_normalised_rms},
                                {"accel", imu.accel_normalised_rms},
                                {"gyro_bias", imu.gyro_bias_normalised_rms},
                                {"accel_bias", imu.accel_bias_normalised_rms}};
  json["frames_used"] = stage.frames.size();
  json["frames_without_imu"] = stage.frames_without_imu;
  json["frames_without_pose"] = stage.frames_without_pose;
  json["imu_gaps"] = stage.imu_gaps;
  json["imu_rate_hz"] = stage.imu_rate_hz;
  json["inertial_check"] = {{"target_scale", stage.inertial_check.target_scale},
                            {"target_scale_std", stage.inertial_check.target_scale_std},
                            {"gravity_m_s2", stage.inertial_check.gravity_m_s2}};
  json["imu_noise"] = noiseChecksOf(imu.noise);
  json["imu_chi2"] = imu.chi2;
  json["imu_dof"] = imu.dof;
  json["gravity_F_m_s2"] = vectorJson(stage.gravity_F);
  return json;
}

Json cameraOf(const CameraCalibration& camera, const ErrorStatistics& errors) {
  const Intrinsics& k = camera.intrinsics;
  Json json{{"name", camera.name}};
  if (!camera.rostopic.empty()) json["rostopic"] = camera.rostopic;
  json["model"] = toString(k.projection_model);
  json["distortion"] = toString(k.distortion_model);
  json["resolution"] = {k.resolution.width, k.resolution.height};
  json["intrinsics"] = vectorJson(k.projection);
  json["distortion_coeffs"] = vectorJson(k.distortion);
  if (camera.intrinsics_std) {
    json["intrinsics_std"] = vectorJson(camera.intrinsics_std->head(k.projection.size()));
    json["distortion_coeffs_std"] = vectorJson(camera.intrinsics_std->tail(k.distortion.size()));
  }
  json["T_C0Ci"] = rowsJson(camera.T_C0Ci.matrix());
  if (camera.T_C0Ci_std) json["T_C0Ci_std"] = vectorJson(*camera.T_C0Ci_std);
  json["rmse_px"] = errors.rmse_px;
  return json;
}

Json imuOf(const ImuCalibration& imu) {
  Json json{{"T_SC0", rowsJson(imu.T_SC0.matrix())}};
  if (imu.T_SC0_std) json["T_SC0_std"] = vectorJson(*imu.T_SC0_std);
  json["time_offset_s"] = imu.time_offset_s;
  if (imu.time_offset_std_s) json["time_offset_std_s"] = *imu.time_offset_std_s;
  json["gravity_m_s2"] = imu.gravity_m_s2;
  if (!imu.rostopic.empty()) json["rostopic"] = imu.rostopic;
  json["noise"] = noiseJson(imu.noise);
  return json;
}

Json covarianceOf(const ParameterCovariance& covariance) {
  Json parameters = Json::array();
  for (std::size_t i = 0; i < covariance.names.size(); ++i) {
    parameters.push_back({{"name", covariance.names[i]}, {"unit", covariance.units[i]}});
  }
  return {{"parameters", parameters}, {"matrix", rowsJson(covariance.matrix)}};
}

Json spreadOf(const ResampleSpread& spread) {
  Json std = Json::object();
  for (std::size_t i = 0; i < spread.names.size(); ++i) {
    std[spread.names[i]] = spread.std[static_cast<Eigen::Index>(i)];
  }
  return {{"resamples", spread.resamples}, {"failed", spread.failed}, {"std", std}};
}

template <class StageResult>
void addRows(fmt::memory_buffer& text, const char* name, const StageResult& stage) {
  for (const CornerResidual& r : stage.residuals) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{}\n", name,
                   stage.frames[r.frame].t, stage.cameras[r.camera].name, r.corner_id, r.uv.x(),
                   r.uv.y(), r.error.x(), r.error.y(), r.used ? 1 : 0);
  }
}

}  // namespace

std::string calibrationDocument(const CalibrationRecord& record) {
  Json json{{"schema", kSchema}};
  const StageSummary* last = nullptr;
  if (record.camera) {
    last = &record.camera->summary;
    json["stages"]["camera"] = stageOf(*last);
    json["covariance"]["camera"] = covarianceOf(last->covariance);
  }
  if (record.camera_imu) {
    last = &record.camera_imu->summary;
    json["stages"]["camera_imu"] = cameraImuOf(*record.camera_imu);
    json["covariance"]["camera_imu"] = covarianceOf(last->covariance);
  }
  json["cameras"] = Json::array();
  for (std::size_t i = 0; i < record.cameras().size(); ++i) {
    json["cameras"].push_back(cameraOf(record.cameras()[i], last->per_camera[i]));
  }
  if (record.camera_imu) json["imu"] = imuOf(record.camera_imu->imu);
  if (record.camera_resample) json["resample"]["camera"] = spreadOf(*record.camera_resample);
  if (record.camera_imu_resample) {
    json["resample"]["camera_imu"] = spreadOf(*record.camera_imu_resample);
  }
  json["assumptions"] = assumptionsJson(record.assumptions);
  json["verdict"] = verdictJson(record.verdict);
  json["provenance"] = provenanceJson(record.provenance);
  return json.dump(2) + "\n";
}

std::string residualsTable(const CalibrationRecord& record) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text),
                 "#stage,timestamp [ns],camera,corner_id,u [px],v [px],e_u [px],e_v [px],used\n");
  if (record.camera) addRows(text, "camera", *record.camera);
  if (record.camera_imu) addRows(text, "camera_imu", *record.camera_imu);
  return fmt::to_string(text);
}

}  // namespace plumbline
