// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/evaluation_document.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/results/record_json.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

Json statisticsJson(const ErrorStatistics& e) {
  Json json = errorsJson(e);
  json["corners"] = e.count;
  return json;
}

Json camerasJson(const CalibrationScore& score) {
  Json json = Json::object();
  for (std::size_t c = 0; c < score.per_camera.size(); ++c) {
    json[score.cameras[c]] = statisticsJson(score.per_camera[c]);
  }
  return json;
}

Json scoreJson(const CalibrationScore& s) {
  Json json{{"label", s.label}, {"session", s.session}, {"part", s.part}, {"held_out", s.held_out}};
  if (!s.problem.empty()) json["problem"] = s.problem;
  if (s.reprojection.count == 0) return json;
  json["reprojection"] = statisticsJson(s.reprojection);
  json["per_camera"] = camerasJson(s);
  json["views_used"] = s.views_used;
  json["views_offered"] = s.views_offered;
  if (s.entropy_nats) {
    json["entropy_nats"] = *s.entropy_nats;
    json["entropy_parameters"] = s.entropy_parameters;
  }
  if (!s.camera_imu) return json;
  json["camera_imu"] = statisticsJson(*s.camera_imu);
  if (s.camera_imu_entropy_nats) {
    json["camera_imu"]["entropy_nats"] = *s.camera_imu_entropy_nats;
    json["camera_imu"]["entropy_parameters"] = s.camera_imu_entropy_parameters;
  }
  if (s.camera_imu_cost) json["camera_imu"]["cost"] = *s.camera_imu_cost;
  if (s.gyro_rms_rad_s) json["camera_imu"]["gyro_rms_rad_s"] = *s.gyro_rms_rad_s;
  if (s.accel_rms_m_s2) json["camera_imu"]["accel_rms_m_s2"] = *s.accel_rms_m_s2;
  return json;
}

Json modelsJson(const std::vector<CameraCalibration>& cameras) {
  Json json = Json::object();
  for (const CameraCalibration& camera : cameras) {
    const Intrinsics& k = camera.intrinsics;
    json[camera.name] = toString(k.projection_model) + "-" + toString(k.distortion_model);
  }
  return json;
}

std::string rmse(const ErrorStatistics* e) {
  const bool known = e != nullptr && e->count > 0;
  return known ? fmt::format("{:>11.4f}", e->rmse_px) : fmt::format("{:>11}", "-");
}

std::string nameOf(const CalibrationScore& s) {
  if (s.part == "all") return s.session + (s.held_out ? ", held out" : "");
  return s.part + (s.held_out ? ", held out" : ", calibrated on");
}

std::string line(const CalibrationScore& s, const std::vector<std::string>& cameras,
                 std::size_t width) {
  if (s.reprojection.count == 0) return fmt::format("{:<{}}  {}\n", nameOf(s), width, s.problem);
  std::string text = fmt::format("{:<{}}", nameOf(s), width) + rmse(&s.reprojection);
  for (const std::string& camera : cameras) text += rmse(errorsOf(s, camera));
  text += rmse(s.camera_imu ? &*s.camera_imu : nullptr);
  text += fmt::format("{:>10}{:>8}\n", s.reprojection.count, s.views_used);
  if (!s.problem.empty()) text += "  " + s.problem + "\n";
  return text;
}

}  // namespace

std::string evaluationDocument(const CalibrationRecord& record) {
  Json scores = Json::array();
  for (const CalibrationScore& score : record.held->scores) scores.push_back(scoreJson(score));
  const Json json{{"schema", kSchema},
                  {"calibration", record.held->file},
                  {"models", modelsJson(record.cameras())},
                  {"scores", scores},
                  {"assumptions", assumptionsJson(record.assumptions)},
                  {"provenance", provenanceJson(record.provenance)}};
  return json.dump(2) + "\n";
}

std::string evaluationSummary(const CalibrationRecord& record) {
  const HeldCalibration& evaluation = *record.held;
  std::size_t width = 0;
  for (const CalibrationScore& score : evaluation.scores) {
    width = std::max(width, nameOf(score).size());
  }
  std::string text = fmt::format("{}\n{:<{}}{:>11}", evaluation.file, "RMSE [px]", width, "all");
  const std::vector<std::string> cameras = cameraNames(evaluation.scores);
  for (const std::string& camera : cameras) text += fmt::format("{:>11}", camera);
  text += fmt::format("{:>11}{:>10}{:>8}\n", "with IMU", "corners", "views");
  for (const CalibrationScore& score : evaluation.scores) text += line(score, cameras, width);
  return text;
}

}  // namespace plumbline
